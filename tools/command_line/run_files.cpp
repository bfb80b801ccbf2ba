#include "run_files.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;

// Equal for the same file only; empty for what can't be destroyed.
std::string identityOf(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) {
        if (!S_ISREG(status.st_mode)) return {};
        return fmt::format("{} {}", status.st_dev, status.st_ino);
    }
    // Not there yet: by its name, links and dots resolved as far as they exist.
    std::error_code failed;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failed), failed);
    return failed ? path : whole.string();
}

// Only --thumbnail writes such files.
bool namesPrint(const std::string& path) {
    constexpr std::array<std::string_view, 8> kEndings = {".gcode",  ".gco", ".g",   ".gx",
                                                          ".bgcode", ".3mf", ".ufp", ".nc"};
    return std::any_of(kEndings.begin(), kEndings.end(), [&path](std::string_view end) { return path.ends_with(end); });
}

}  // namespace

void RunFiles::reads(const std::string& path) {
    if (path.empty() || path == "-") return;
    const std::string identity = identityOf(path);
    if (!identity.empty()) uses_.try_emplace(identity, Use{path, "", true});
}

void RunFiles::writes(const std::string& path, std::string_view option, Kind kind) {
    if (path.empty()) return;
    const bool standard = isStandardOutput(path);
    const std::string identity = standard ? "-" : identityOf(path);
    if (identity.empty()) return;
    const auto [found, fresh] = uses_.try_emplace(identity, Use{path, std::string(option), false});
    if (fresh) {
        // "--stats a.gcode b.gcode" means two prints, and takes the first for the report's name.
        if (kind == Kind::other && !standard && namesPrint(path) && fs::exists(path))
            throw UsageError(fmt::format(
                "{} {}: is there already, and a print by its name; it would be overwritten, give another name", option,
                path));
        return;
    }
    const Use& before = found->second;
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
