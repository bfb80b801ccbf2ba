// Printed plastic: its gloss has the direction of the lines.
#pragma once

#include "shade/brdf/plastic.h"

#include <string>
#include <string_view>

namespace stratum::shade {

/// What the nozzle draws along a line is smooth along it and rough across, which makes a surface of lines shine as
/// brushed metal does: X. Chermain et al., "Orientable Dense Cyclic Infill for Anisotropic Appearance Fabrication",
/// SIGGRAPH 2023; S. Boc, "Anisotropic reflectance model for predictive rendering of FDM prints", Ljubljana 2023. No
/// measured alpha of a single line was found: the number is by eye, of photographs of top surfaces.
inline constexpr float kLineRatio = 2.5f;  ///< alpha across the line over alpha along it
inline constexpr float kMostLineRatio = 20.0f;

/// Plastic (plastic.h) with x along the line.
/// @param body   its reflectance, in [0, 1]
/// @param alpha  GGX's, the geometric mean of both directions, in [Plastic::kMinAlpha, 1]
/// @param ratio  across over along, in [1, kMostLineRatio]
Plastic plasticOfLines(const Color& body, float alpha, float ratio = kLineRatio);

/// The text of that plastic (see makeBrdf) for the text of another material: of a colour, or of nothing, which is
/// kDefaultBrdf's; other texts stay as they are.
std::string withGlossOfLines(std::string_view text);
/// Whether the material of this text is plasticOfLines().
bool hasGlossOfLines(std::string_view text);

}  // namespace stratum::shade
