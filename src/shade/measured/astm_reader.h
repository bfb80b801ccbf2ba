// ASTM E1392 bidirectional scatter data.
#pragma once

#include "shade/brdf/brdf_scan.h"

#include <string_view>

namespace stratum::shade {

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
