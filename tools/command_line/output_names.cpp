#include "output_names.h"

#include "base/error.h"
#include "gcode/container/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>

namespace stratum::tools {

namespace fs = std::filesystem;

std::string stemOf(const std::string& input) {
    if (gcode::isStream(input))
        throw UsageError(
            fmt::format("{} has no name to call the output by; give -o FILE", input == "-" ? "standard input" : input));
    fs::path name = fs::path(input).filename();
    if (name.extension() == ".gz" || name.extension() == ".3mf") name = name.stem();
    return name.stem().string();
}

std::string commonStem(const std::vector<std::string>& inputs) {
    std::vector<std::string> stems;
    stems.reserve(inputs.size());
    for (const std::string& input : inputs) stems.push_back(stemOf(input));
    std::string common = stems.front();
    for (const std::string& stem : stems)
        common.erase(std::mismatch(common.begin(), common.end(), stem.begin(), stem.end()).first, common.end());
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    // 025 and 050 begin with the same 0: numbers are not torn.
    const bool torn = std::any_of(stems.begin(), stems.end(), [&](const std::string& stem) {
        return stem.size() > common.size() && digit(stem[common.size()]);
    });
    while (torn && !common.empty() && (digit(common.back()) || common.back() == '.')) common.pop_back();
    const bool parted = std::any_of(stems.begin(), stems.end(), [&](const auto& stem) { return stem != common; });
    constexpr std::string_view kSeparators = "_-. ";
    while (parted && !common.empty() && kSeparators.find(common.back()) != std::string_view::npos) common.pop_back();
    return common.empty() ? "series" : common;
}

bool namesFolder(const std::string& output) {
    std::error_code ignored;
    return output.ends_with('/') || (!output.empty() && fs::is_directory(output, ignored));
}

void makeFolder(const fs::path& folder) {
    std::error_code failed;
    if (folder.empty() || fs::is_directory(folder, failed)) return;
    fs::create_directories(folder, failed);
    if (failed) throw OutputError(fmt::format("{}: the folder can't be made ({})", folder.string(), failed.message()));
}

}  // namespace stratum::tools
