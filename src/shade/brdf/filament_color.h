// The colour that a maker, a slicer or a person names for a filament, and the plastic that shows it.
#pragma once

#include "shade/color.h"

#include <optional>
#include <string>
#include <string_view>

namespace stratum::shade {

/// "#RRGGBB", "#RGB", or a colour's name in CSS Color 4, e.g. "teal", in any case of letters. Linear RGB of the sRGB
/// that is meant; nothing for other texts.
std::optional<Color> parseNamedColor(std::string_view text);

/// "#rrggbb" of linear RGB, the nearest.
std::string hexOf(const Color& linear);

/// Body reflectance of a satin plastic that is seen as about this colour where the studio's light falls on it: between
/// the faces that look up and the upright ones. Black plastic still reflects a little, and white plastic not all: each
/// channel is from kBlackest to kWhitest.
Color bodyOf(const Color& stated);
inline constexpr float kBlackest = 0.012f;
inline constexpr float kWhitest = 0.86f;

/// GGX's alpha of its coat, that of kDefaultBrdf.
inline constexpr float kFilamentAlpha = 0.22f;

}  // namespace stratum::shade
