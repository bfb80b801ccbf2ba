// Named colors of filaments, and the reflectance of plastic that appears in such a color.
#pragma once

#include "shade/color.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::shade {

/// Parses "#RRGGBB", "#RGB", or a color's name in CSS Color 4, e.g. "teal", in any case of letters. Linear RGB of that
/// sRGB color; nothing for other texts.
std::optional<Color> parseNamedColor(std::string_view text);

/// Linear RGB of the sRGB color 0xRRGGBB.
Color fromSrgb(std::uint32_t hex);

/// "#rrggbb" of linear RGB, the nearest.
std::string hexOf(const Color& linear);

/// Body reflectance of a satin plastic that appears in about this color in the studio's light: a compromise between
/// horizontal and vertical faces. Each channel is in [kBlackest, kWhitest], because black plastic reflects a little,
/// and white plastic not everything.
Color bodyOf(const Color& stated);
inline constexpr float kBlackest = 0.012f;
inline constexpr float kWhitest = 0.86f;

/// GGX's alpha of its coat, that of kDefaultBrdf.
inline constexpr float kFilamentAlpha = 0.22f;

}  // namespace stratum::shade
