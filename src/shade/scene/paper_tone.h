// The tone of the paper under a print, so that the print stands out from it.
#pragma once

#include "shade/color.h"
#include "shade/scene/scene.h"

#include <span>

namespace stratum::shade {

/// The difference of two reflectances as they look on white paper, CIE 1976 (L*a*b*, D65).
double colorDifference(const Color& a, const Color& b);

/// The reflectance of the paper for parts of these colors: light, as BedSurface::paper is, unless a part is nearer to
/// it than kLeastDifference. Then it is gray with a quarter of the luminance of the darkest such part, if that is
/// farther from all parts.
Color paperFor(std::span<const Color> parts);
inline constexpr double kLeastDifference = 25.0;  ///< CIE 1976; the light of the studio differs by as much

/// Gives the paper of a scene, and the backdrop, that tone. A print of several filaments counts as parts of their
/// colors. Scenes whose objects have colors for other values keep the light paper, as do other bed surfaces and
/// transparent pictures.
void matchPaper(SceneDescription& scene, BedSurface surface);

}  // namespace stratum::shade
