#include "shade/data_folder.h"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>

namespace stratum::shade {

std::filesystem::path dataFolder() {
    namespace fs = std::filesystem;
    if (const char* data = std::getenv("STRATUM_DATA")) return data;
    // Installed tables are found relative to the program in bin, or to the Python module in
    // lib/python3/dist-packages/stratum, so the tree can be moved.
    std::error_code missing;
    const fs::path program = fs::read_symlink("/proc/self/exe", missing);
    Dl_info code{};
    const bool found = dladdr(reinterpret_cast<const void*>(&dataFolder), &code) != 0 && code.dli_fname != nullptr;
    const fs::path module = found ? fs::path(code.dli_fname).parent_path() : fs::path();
    const fs::path prefix = module.filename() == "stratum"
                                ? module.parent_path().parent_path().parent_path().parent_path()
                                : program.parent_path().parent_path();
    fs::path installed = prefix / "share/stratum/data";
    if (fs::is_directory(installed, missing)) return installed;
    return STRATUM_DATA_DIR;
}

}  // namespace stratum::shade
