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

// "0.2": no name of a filament ("Stratum 3D PLA").
bool beginsWithVersion(std::string_view text) {
    const std::size_t dot = text.find_first_not_of("0123456789");
    return dot != 0 && dot != std::string_view::npos && text[dot] == '.' && dot + 1 < text.size() &&
           isDigit(text[dot + 1]);
}

// What stands before the mark in the texts that these programs write. Other people's texts may name them, too.
bool introduces(std::string_view before) {
    constexpr std::array<std::string_view, 8> kWords = {
        "by ", "\"program\": \"", "\"program\":\"", "\"generator\":\"", ">", "UTC, ", ",", "\n"};
    return std::any_of(kWords.begin(), kWords.end(),
                       [before](std::string_view word) { return before.ends_with(word); });
}

// A name with a version behind it.
bool hasMark(std::string_view bytes, bool is_text) {
    constexpr std::array<std::string_view, 6> kNames = {"Stratum ",  "stratum ",  "gcode2vdb ",
                                                        "vdbtrace ", "vdbmerge ", "vdbstudy "};
    return std::any_of(kNames.begin(), kNames.end(), [&](std::string_view name) {
        for (std::size_t at = bytes.find(name); at != std::string_view::npos; at = bytes.find(name, at + 1))
            if (beginsWithVersion(bytes.substr(at + name.size())) && (!is_text || introduces(bytes.substr(0, at))))
                return true;
        return false;
    });
}

}  // namespace

bool isOwnFile(const std::filesystem::path& path) {
    constexpr std::size_t kSearched = std::size_t{1} << 20;
    // Files without room for a mark: a table of beads, and the parts of a picture, whose attribute has this name.
    constexpr std::string_view kTable = "line,layer,feature,tool,object,x0,y0,z0,";
    constexpr std::string_view kPart = "StratumPart";
    constexpr std::string_view kCheckpoint = "stratum checkpoint ";
    try {
        const InputFile file(path);
        const std::size_t searched = std::min(file.size(), kSearched);
        const std::string_view first = file.first(searched);
        const bool is_text = first.find('\0') == std::string_view::npos;
        if (first.starts_with(kTable) || first.starts_with(kCheckpoint) ||
            first.find(kPart) != std::string_view::npos || hasMark(first, is_text))
            return true;
        file.load(file.size() - searched, searched);
        return hasMark(file.unread().substr(file.size() - searched), is_text);
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace stratum
