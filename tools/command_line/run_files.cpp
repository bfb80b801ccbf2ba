#include "run_files.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "gcode/container/container.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;

// Each equal for the same file only: by its place in the file system, where it exists, and by its name, links and dots
// resolved as far as they exist: an output is replaced, and then is another file. Empty for what can't be destroyed.
std::vector<std::string> identitiesOf(const std::string& path) {
    std::vector<std::string> identities;
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) {
        if (!S_ISREG(status.st_mode)) return {};
        identities.push_back(fmt::format("{} {}", status.st_dev, status.st_ino));
    }
    std::error_code failed;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failed), failed);
    identities.push_back(failed ? path : whole.string());
    return identities;
}

}  // namespace

void RunFiles::reads(const std::string& path) {
    if (path.empty() || gcode::isStream(path)) return;
    for (const std::string& identity : identitiesOf(path)) uses_.try_emplace(identity, Use{path, "", true});
}

void RunFiles::writes(const std::string& path, std::string_view option) {
    use(path, option);
    if (!path.empty()) Replacement::check(path);
}

void RunFiles::writesBeside(const std::string& path, std::string_view option) {
    writes(path, option);
    if (!path.empty() && !isStandardOutput(path)) AtomicFile::probe(path);
}

void RunFiles::use(const std::string& path, std::string_view option) {
    if (path.empty()) return;
    const bool standard = isStandardOutput(path);
    const std::vector<std::string> identities = standard ? std::vector<std::string>{"-"} : identitiesOf(path);
    const auto known = std::find_if(identities.begin(), identities.end(),
                                    [this](const std::string& identity) { return uses_.contains(identity); });
    if (known == identities.end()) {
        for (const std::string& identity : identities) uses_.emplace(identity, Use{path, std::string(option), false});
        return;
    }
    const Use& before = uses_.at(*known);
    const std::string what = option.empty() ? path : fmt::format("{} {}", option, path);
    if (before.read)
        throw UsageError(before.path == path
                             ? fmt::format("{}: is an input; give another name, it would be overwritten", what)
                             : fmt::format("{}: is the same file as the input {}; give another name, it would be "
                                           "overwritten",
                                           what, before.path));
    if (standard)
        throw UsageError(fmt::format("{} and {} {}: only one can go to standard output; give the other a file", what,
                                     before.option, before.path));
    throw UsageError(fmt::format("{}: is written already{}; give them different names", what,
                                 before.option.empty() ? fmt::format(" (as {})", before.path)
                                                       : fmt::format(" by {} {}", before.option, before.path)));
}

}  // namespace stratum::tools
