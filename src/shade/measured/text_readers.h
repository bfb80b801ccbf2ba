// Measured materials as text: Mini-Diff, Zemax and ASTM E1392.
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <string_view>

namespace stratum::shade {

// The text format of the Mini-Diff scatterometer, which is the BSDF text of LightTools.

/// Whether a text looks like it.
bool isMiniDiff(std::string_view text);

/// Blocks of AOI, POI, Side, Wavelength, ScatterType, TIS and a matrix of azimuths x radials; radials are polar angles
/// to the normal. Only the front side's BRDF is used. Azimuths may have any origin: the mirror direction is found by
/// its brightness. TIS, the file's own integral, is compared with the table's, and a difference is noted.
/// @param name  of the file, for messages
/// Throws InputError with the line.
BrdfScan readMiniDiff(std::string_view text, std::string_view name);

// Zemax tabular BSDF (the interchange format of Radiant Imaging).

/// Whether a text looks like it.
bool isZemax(std::string_view text);

/// Angles are polar about the mirror direction: radial 0 is the mirror direction, azimuth 0 is from there towards the
/// normal. Directions below the horizon are skipped. The scan is resampled about the normal, 5 x 2 degrees and as fine
/// as the file near the mirror direction. Source: R. Rykowski, "BSDF Data Interchange File Format Specification", Zemax
/// knowledge base, 2008.
/// @param name  of the file, for messages
/// Throws InputError with the line.
BrdfScan readZemax(std::string_view text, std::string_view name);

// ASTM E1392 bidirectional scatter data.

/// Whether a text looks like it.
bool isAstm(std::string_view text);

/// A header of keywords, VARS theta_i,phi_i,theta_s,phi_s and names of channels (R,G,B; X,Y,Z; wavelengths such as
/// 550nm; or one of any name), then a line a reading, in radians or, if a number is beyond 2 pi, degrees. Readings must
/// form a grid for each incidence; azimuths are taken relative to phi_i.
/// Source: ASTM E1392-96, section 11, as Cornell's reflectance database uses it.
/// @param name  of the file, for messages
/// Throws InputError with the line.
BrdfScan readAstm(std::string_view text, std::string_view name);

}  // namespace stratum::shade
