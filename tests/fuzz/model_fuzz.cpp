// libFuzzer: any bytes as a model, .3mf, .stl or .obj by how they begin, that a small print is compared with. Only
// InputError and UsageError may come out of it, and what is told must be finite numbers.
//
// How to build and run it stands in scripts/fuzz.sh. Assimp reads in a process of its own, whose crashes are told as
// damaged files.
#include "base/error.h"
#include "compare/comparison.h"
#include "compare/model_file.h"
#include "fuzz/require.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace {

namespace fs = std::filesystem;

// A folder of this process: models are told by the endings of their names.
class Folder {
public:
    Folder() : path_(fs::temp_directory_path() / ("stratum_model_fuzz_" + std::to_string(::getpid()))) {
        fs::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    fs::path write(std::string_view bytes) const {
        const bool is_text = bytes.starts_with("v ") || bytes.starts_with("#") || bytes.starts_with("o ");
        const fs::path path = path_ / (bytes.starts_with("PK") ? "model.3mf" : is_text ? "model.obj" : "model.stl");
        std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return path;
    }

private:
    const fs::path path_;
};

void check(const stratum::compare::Deviations& found) {
    for (const double value : {found.mean, found.rms, found.within_95, found.least.mm, found.most.mm})
        require(std::isfinite(value));
}

void compare(const fs::path& path, bool fit) {
    using namespace stratum::compare;
    static const openvdb::FloatGrid::Ptr print =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(3.0F, openvdb::Vec3f(3, 4, 3), 0.5F);
    const ClosedModel model(readModel(path), path.string());
    CompareOptions options;
    options.samples = 120;
    options.placement = fit ? ModelPlacement::fit : ModelPlacement::bed;
    const Comparison found = compareToModel(*print, model, options);
    check(found.print_to_model.all);
    check(found.model_to_surface.all);
    require(std::isfinite(found.model_mm3) && std::isfinite(found.model_mm2));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Folder folder;
    openvdb::initialize();
    try {
        // The search for a placement takes a hundred times longer than the rest.
        compare(folder.write({reinterpret_cast<const char*>(data), size}), size % 8 == 0);
    } catch (const stratum::InputError&) {
    } catch (const stratum::UsageError&) {
    }
    return 0;
}
