// The comments in which slicers write their settings: in the first and the last part of a program.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace stratum::gcode {

/// Bytes. Because of thumbnails and Cura's SETTING_3 lines, settings can be this far from the ends.
inline constexpr std::size_t kSettingsReach = std::size_t{1} << 18;

/// The last part of the program, without what the first part has, from the beginning of a line.
inline std::string_view settingsTail(std::string_view bytes) {
    if (bytes.size() <= kSettingsReach) return {};
    std::string_view tail = bytes.substr(std::max(kSettingsReach, bytes.size() - kSettingsReach));
    // It may start inside a line, which must not be taken for a comment.
    tail.remove_prefix(std::min(tail.find_first_of("\r\n"), tail.size()));
    return tail;
}

/// Calls visit(mark, text) for each line of both parts that is a comment: mark is ';' or '(', text what follows.
template <typename Visit>
void forEachSettingsComment(std::string_view bytes, const Visit& visit) {
    for (std::string_view part : {bytes.substr(0, kSettingsReach), settingsTail(bytes)})
        while (!part.empty()) {
            const auto end = std::min(part.find_first_of("\r\n"), part.size());
            if (part.front() == ';' || part.front() == '(') visit(part.front(), part.substr(1, end - 1));
            part.remove_prefix(std::min(end + 1, part.size()));
        }
}

}  // namespace stratum::gcode
