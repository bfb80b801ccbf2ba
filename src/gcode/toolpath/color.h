// Colors of filaments: "#rrggbb", as slicers write them.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// Red, green, blue, sRGB.
using Rgb = std::array<std::uint8_t, 3>;

/// sRGB of a text that begins with '#' and six hexadecimal digits; nullopt for any other.
inline std::optional<Rgb> parseColor(std::string_view text) {
    if (text.size() < 7 || text.front() != '#') return std::nullopt;
    Rgb color{};
    for (std::size_t i = 0; i < 3; ++i) {
        const char* const first = text.data() + 1 + 2 * i;
        const auto [end, error] = std::from_chars(first, first + 2, color[i], 16);
        if (error != std::errc{} || end != first + 2) return std::nullopt;
    }
    return color;
}

/// "#rrggbb".
inline std::string colorText(const Rgb& color) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text = "#";
    for (const std::uint8_t value : color) text.append({kDigits[value >> 4U], kDigits[value & 15U]});
    return text;
}

}  // namespace stratum::gcode
