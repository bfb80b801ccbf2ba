// The second pass over a toolpath: computes heights and widths from areas.
//
// The simulator has each bead's cross-section area (from E) and, if the slicer tagged it, its height. The height of an
// untagged bead can be found only when all z levels are known. Source of the section: Slic3r's Flow (stadium).
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <optional>
#include <span>
#include <vector>

namespace stratum::gcode {

// Heights of the nozzle above earlier material at each position: for beads whose height follows neither from a tag nor
// from the levels of the print: spirals, supports with layers of their own, objects printed one after another.
//
// The plan is a sparse grid of cells; each stores the z of the last pass through it and of the one below. The rise of a
// bead is its z above the last pass underneath; a run's height is the median over its length, which ignores edges and
// overhangs.

struct LocalRise {
    double median = 0;  ///< mm; 0 if nothing lies below
    double share = 0;   ///< share (0..1) of the length that has material below
};

/// By run, in print order. `wanted[k]`: whether to compute the rise of run k. All runs but those of layer 0 count as
/// material. O(length / 1 mm) time, O(printed area) memory.
std::vector<LocalRise> localRises(const Toolpath& toolpath, const std::vector<bool>& wanted);

// Finds the layer heights of beads without a height tag.
//
// A level run rests on the next lower level with extrusion, or on the bed. Where the print is not a plain stack of
// layers (spirals, supports with layers of their own, objects one after another), the material below each position is
// used instead (localRises()). Bridges without a tag are round threads; the height of ironing follows from its area.
// Sources: Slic3r's Flow (a bridge's thread is round); otherwise measured from the files themselves.

/// mm, by run, positive; tagged heights don't change. `run_z[k]` is the z of level run k, NaN for a sloped one; the
/// beads' widths are areas in mm^2. Layers of spirals in files without a layer height are recounted. Prime lines
/// (layer 0) rest on the bed. `nominal` (mm) defaults to 0.2, with a warning if it is needed.
std::vector<double> findHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal,
                                WarningLog& warnings);

/// Finds the heights of runs that no tag has set. Those that are set stay.
void resolveHeights(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                    WarningLog& warnings);

/// `toolpath.beads[i].width` holds the section's area in mm^2 and becomes the width in mm. `toolpath.runs[k].height` is
/// the tagged height, or 0 if findHeights() must find it; `run_z` and `nominal_height` are its parameters. Warns of the
/// last layer if the program is truncated.
void resolveSections(Toolpath& toolpath, std::span<const double> run_z, std::optional<double> nominal_height,
                     WarningLog& warnings);

}  // namespace stratum::gcode
