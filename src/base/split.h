// Lists in texts.
#pragma once

#include <string_view>
#include <vector>

namespace stratum {

/// The pieces between separators: at least one, which may be empty.
inline std::vector<std::string_view> split(std::string_view text, char separator = ',') {
    std::vector<std::string_view> pieces;
    while (true) {
        const std::size_t end = text.find(separator);
        pieces.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return pieces;
        text.remove_prefix(end + 1);
    }
}

/// The same of a list that may be empty, or end with a separator.
inline std::vector<std::string_view> splitList(std::string_view text, char separator = ',') {
    std::vector<std::string_view> pieces = split(text, separator);
    if (pieces.back().empty()) pieces.pop_back();
    return pieces;
}

}  // namespace stratum
