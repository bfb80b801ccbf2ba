// The text format of the Mini-Diff scatterometer, which is the BSDF text of LightTools.
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <string_view>

namespace stratum::shade {

/// Whether a text looks like it.
bool isMiniDiff(std::string_view text);

/// Blocks of AOI, POI, Side, Wavelength, ScatterType, TIS and a matrix of azimuths x radials; radials are polar angles
/// to the normal. Only the front side's BRDF is used. Azimuths may have any origin: the mirror direction is found by
/// its brightness. TIS, the file's own integral, is compared with the table's, and a difference is noted.
/// @param name  of the file, for messages
/// Throws InputError with the line.
BrdfScan readMiniDiff(std::string_view text, std::string_view name);

}  // namespace stratum::shade
