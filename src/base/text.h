// Letters, blanks and lists of what programs write: ASCII, whatever the locale.
#pragma once

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace stratum {

/// Without the characters of `blanks` at both ends.
constexpr std::string_view trim(std::string_view text, std::string_view blanks = " \t") {
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Without blanks, line ends of Windows and quotes at both ends: values as slicers write them.
constexpr std::string_view trimQuoted(std::string_view text) { return trim(text, " \t\r\""); }

/// A to Z, in either case.
constexpr bool isLetter(char c) {
    const char lower = static_cast<char>(c | 0x20);
    return lower >= 'a' && lower <= 'z';
}

constexpr char lowerCase(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; }
constexpr char upperCase(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c & ~0x20) : c; }

inline std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return lowerCase(c); });
    return text;
}
inline std::string upperCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return upperCase(c); });
    return text;
}

/// On one line, without what a terminal obeys: control characters become blanks.
inline std::string onOneLine(std::string_view text) {
    std::string line(text);
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
    return line;
}

/// The number that the whole text is; nothing if it is none, or does not fit.
/// @param base  of whole numbers, 10 by default
template <typename Number, typename... Base>
std::optional<Number> parsed(std::string_view text, Base... base) {
    Number value{};
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value, base...);
    return error == std::errc{} && end == last ? std::optional(value) : std::nullopt;
}

/// What stands before the first of `ends`, or all of the text. Removes it, with that end, from the text.
template <typename Ends>
std::string_view takePiece(std::string_view& text, Ends ends) {
    const std::string_view piece = text.substr(0, text.find_first_of(ends));
    text.remove_prefix(std::min(piece.size() + 1, text.size()));
    return piece;
}

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
