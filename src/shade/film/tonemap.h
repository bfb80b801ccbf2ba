// Tone mapping: from linear light to 8-bit sRGB.
#pragma once

#include "shade/color.h"
#include "shade/film/film.h"

#include <cstdint>
#include <vector>

namespace stratum::shade {

struct ToneOptions {
    double exposure = 0.0;  ///< stops: radiance is scaled by 2^exposure, in [-30, 30]

    /// Throws UsageError.
    void validate() const;
};

/// Khronos PBR Neutral: base colors keep their hue and value up to about 0.8, highlights roll off to white.
/// Input: linear, >= 0. Output: linear, in [0, 1].
/// Source: https://github.com/KhronosGroup/ToneMapping/tree/main/PBR_Neutral
Color toneMapNeutral(Color color);

/// The sRGB transfer function (IEC 61966-2-1): linear [0, 1] -> encoded [0, 1].
float encodeSrgb(float linear);

/// 8-bit RGB, row by row from the top.
/// Radiance is tone-mapped; shares are sRGB-encoded; normals become (n + 1) / 2; depth goes from white (near) to black;
/// positions from black to the primaries along each axis' range.
/// Light gets a fixed dither of half a step so that a smooth backdrop shows no bands.
std::vector<std::uint8_t> toDisplay(const Film& film, const ToneOptions& options = {});

/// 8-bit RGBA of the same, for transparent films: the colors are those of what is there, not multiplied by alpha
/// ("straight", as PNG, WebP and QOI have them); 0 where alpha rounds to 0. Where radiance is partly let through,
/// colors and alpha are those with which programs that mix encoded values (browsers, most editors) show what light
/// would give: a shadow of alpha a has 1 - encodeSrgb(1 - a).
std::vector<std::uint8_t> toDisplayWithAlpha(const Film& film, const ToneOptions& options = {});

/// 8-bit RGB of 8-bit RGBA over black: for kinds of pictures that have no alpha.
std::vector<std::uint8_t> overBlack(const std::vector<std::uint8_t>& rgba);

}  // namespace stratum::shade
