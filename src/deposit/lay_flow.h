// FlowRecord -> pieces of beads: parts get widths, spots become discs.
#pragma once

#include "deposit/bead_cutter.h"
#include "deposit/flow_record.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <functional>

namespace stratum::deposit {

/// Volumes in mm^3: fed = laid + in_nozzle, laid = in_parts + in_discs + in_strings + purged.
struct FlowReport {
    double lag = 0;              ///< s
    double longest_advance = 0;  ///< s, the largest pressure advance in force
    double fed = 0;              ///< that the extruder has moved at its furthest
    double laid = 0;
    double in_parts = 0;
    double in_discs = 0;
    double in_strings = 0;
    double purged = 0;      ///< flowed out where nothing is printed; not in the toolpath
    double in_nozzle = 0;   ///< not yet flowed out at the end, or drawn back
    std::size_t beads = 0;  ///< of the file
    std::size_t parts = 0;
    std::size_t discs = 0;
    std::size_t strings = 0;
    double strings_mm = 0;  ///< length of all strings, in the plan
};

/// Plastic at one place of more than this is a purge, mm^3: real printers push it off beside the part.
constexpr double kMostInDisc = 10;

/// The radius (mm) of the disc that adds this area (mm^2) to a path of this half width (mm): beyond its end, or, of a
/// place inside a path, beside it.
double discRadius(double half_width, double area, bool inside);

/// Lays the beads that flow out instead of those of the file, as pieces of them. Open paths end a little earlier than
/// in the file, so that the half discs at their ends add nothing to what was fed. Strings hang by the toolpath's sag.
/// Widths are finite and positive; a round thread thinner than kThinnestThread is laid with what follows it.
FlowReport layFlow(const FlowRecord& record, const gcode::Toolpath& toolpath,
                   const std::function<void(const BeadPiece&)>& lay);

}  // namespace stratum::deposit
