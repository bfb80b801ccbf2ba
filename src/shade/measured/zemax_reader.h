// Zemax tabular BSDF (the interchange format of Radiant Imaging).
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <string_view>

namespace stratum::shade {

/// Whether a text looks like it.
bool isZemax(std::string_view text);

/// Angles are polar about the mirror direction: radial 0 is the mirror direction, azimuth 0 is from there towards the
/// normal. Directions below the horizon are skipped. The scan is resampled about the normal, 5 x 2 degrees and as fine
/// as the file near the mirror direction. Source: R. Rykowski, "BSDF Data Interchange File Format Specification", Zemax
/// knowledge base, 2008.
/// @param name  of the file, for messages
/// Throws InputError with the line.
BrdfScan readZemax(std::string_view text, std::string_view name);

}  // namespace stratum::shade
