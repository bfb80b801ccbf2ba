// A BRDF as an EXR texture: a tile for each angle of incidence.
#pragma once

#include "shade/brdf/brdf_scan.h"
#include "shade/film/exr.h"

#include <filesystem>

namespace stratum::shade {

/// Reads a texture whose tiles have the azimuth between light and detector across (0 to 2 pi) and the polar angle
/// down (0 to pi/2), in 1/sr. The layout follows from string attributes; missing ones are estimated:
///   layout   "CxR" tiles across and down, or numbers `columns` and `rows` (also tilesX, tilesY). Else 4x1, 1x4 or 2x2,
///            the one with the largest discontinuities at its seams.
///   thetaI   (also theta_i, incidences) angles of incidence in degrees, separated by commas. Else 0, 20, 40, 60.
///   sampling "nodes": the first and last texel lie on the ends of the range; "centers": half a texel inside. Else
///   nodes
///            along odd sizes and centers along even ones.
///   meaning  "detector": angles of the detector; "half": of the half vector. Else by where the highlight sits: near
///   the
///            mirror direction, or at the top of all tiles.
/// The azimuth of the mirror direction is found by its brightness, as in all scans.
/// Source of the layout: J. Spilar, "Visualization of 3D printing via ray tracing", CTU Prague 2025.
/// Throws InputError.
BrdfScan readBrdfExr(const std::filesystem::path& path);

/// Writes a scan over azimuths [0, pi] as such a texture, layout 1xN, nodes, with all attributes. Atomic.
/// Throws OutputError.
void writeBrdfExr(const std::filesystem::path& path, const BrdfScan& scan);

}  // namespace stratum::shade
