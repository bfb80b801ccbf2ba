// Settings as slicers write them in comments: "key = value", lists, quotes.
#pragma once

#include "base/text.h"
#include "gcode/text/number.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::gcode {

/// Of lists by tool: more parts are not read.
inline constexpr std::size_t kMostParts = 256;

/// Removes `prefix` and what trimQuoted() removes; false, and no change, if the text begins otherwise.
inline bool takePrefix(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text = trimQuoted(text.substr(prefix.size()));
    return true;
}

/// The two sides of the first " = ", the value without blanks and quotes.
inline std::optional<std::pair<std::string_view, std::string_view>> keyAndValue(std::string_view text) {
    const auto equals = text.find(" = ");
    if (equals == std::string_view::npos) return std::nullopt;
    return std::pair(text.substr(0, equals), trimQuoted(text.substr(equals + 3)));
}

/// The parts of a list, without blanks and quotes. A separator at the end makes no part.
inline std::vector<std::string_view> partsOf(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> parts;
    while (!text.empty() && parts.size() < kMostParts) parts.push_back(trimQuoted(takePiece(text, separators)));
    return parts;
}

/// The number that each part of a list begins with; empty if one has none in [least, most].
inline std::vector<double> numbersOf(std::string_view text, double least, double most) {
    std::vector<double> values;
    for (const std::string_view part : partsOf(text, ",")) {
        const char* p = part.data();
        double value = 0;
        if (!parseNumber(p, p + part.size(), value) || !(value >= least && value <= most)) return {};
        values.push_back(value);
    }
    return values;
}

/// The positive number that the text begins with, if it is at most `most`.
inline std::optional<double> positiveNumber(std::string_view text, double most) {
    text = trimQuoted(text);
    const char* p = text.data();
    double value = 0;
    if (!parseNumber(p, p + text.size(), value) || !(value > 0 && value <= most)) return std::nullopt;
    return value;
}

// The comments in which slicers write their settings: in the first and the last part of a program.

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
            const std::string_view line = takePiece(part, "\r\n");
            if (line.starts_with(';') || line.starts_with('(')) visit(line.front(), line.substr(1));
        }
}

}  // namespace stratum::gcode
