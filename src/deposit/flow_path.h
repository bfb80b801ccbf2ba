// The flow along an unbroken path: averaged over the width of the nozzle, and divided into parts of linear section.
#pragma once

#include "deposit/flow_record.h"

#include <cstddef>
#include <span>
#include <vector>

namespace stratum::deposit {

/// A part's section is within this of the averaged one, as a fraction of the commanded section.
constexpr double kSectionTolerance = 0.02;

/// A sample of the flow: what is laid between two places of a bead.
struct FlowInterval {
    std::uint32_t bead = 0;
    bool tapers = false;    ///< a straight level bead, whose section may change along a part
    double s0 = 0, s1 = 0;  ///< mm along the bead
    double commanded = 0;   ///< mm^2, the section that the program states
    double volume = 0;      ///< mm^3
    double t0 = 0, t1 = 0;  ///< s
};

/// What flows out at rest before interval `before` of a path, or at its end.
struct PathSpot {
    std::size_t before = 0;
    double volume = 0;  ///< mm^3
    double time = 0;    ///< s
};

/// Appends the parts and spots of a path, which is not empty. Spots of little volume become part of the path beside
/// them. Spots are ascending. A closed path ends where it begins. The flow is averaged over at least `least` mm of the
/// path, the width of the nozzle, for so long each place lies under its opening: without that a stop of no length would
/// have an infinite section.
void dividePath(std::span<const FlowInterval> path, std::span<const PathSpot> spots, bool closed, double least,
                FlowRecord& record);

}  // namespace stratum::deposit
