#include "base/own_file.h"

#include "base/error.h"
#include "base/input_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace stratum {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

// A name with a version behind it.
bool hasMark(std::string_view bytes) {
    constexpr std::array<std::string_view, 7> kNames = {"Stratum ",  "stratum ",  "gcode2vdb ",         "vdbtrace ",
                                                        "vdbmerge ", "vdbstudy ", "stratum checkpoint "};
    return std::any_of(kNames.begin(), kNames.end(), [bytes](std::string_view name) {
        for (std::size_t at = bytes.find(name); at != std::string_view::npos; at = bytes.find(name, at + 1))
            if (at + name.size() < bytes.size() && isDigit(bytes[at + name.size()])) return true;
        return false;
    });
}

}  // namespace

bool isOwnFile(const std::filesystem::path& path) {
    constexpr std::size_t kSearched = std::size_t{1} << 20;
    // Files without room for a mark: a table of beads, and the parts of a picture, whose attribute has this name.
    constexpr std::string_view kTable = "line,layer,feature,tool,object,x0,y0,z0,";
    constexpr std::string_view kPart = "StratumPart";
    try {
        const InputFile file(path);
        const std::size_t searched = std::min(file.size(), kSearched);
        const std::string_view first = file.first(searched);
        if (first.starts_with(kTable) || first.find(kPart) != std::string_view::npos || hasMark(first)) return true;
        file.load(file.size() - searched, searched);
        return hasMark(file.unread().substr(file.size() - searched));
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace stratum
