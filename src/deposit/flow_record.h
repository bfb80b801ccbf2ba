// What a simulated flow lays: parts of beads and spots, as volumes; lay_flow.h makes beads of them.
#pragma once

#include <cstdint>
#include <vector>

namespace stratum::deposit {

/// A part of a bead with one section, or one that changes linearly.
struct FlowPart {
    std::uint32_t bead = 0;
    double from = 0, to = 1;  ///< fractions of the bead's path
    double volume = 0;        ///< mm^3 laid
    double growth = 0;        ///< mm^2, the section at the end less that at the start
    double start = 0;         ///< s since the program's begin
    double seconds = 0;       ///< that it takes
    bool begins = false;      ///< an open path
    bool ends = false;        ///< likewise
};

/// What flows out while the nozzle rests at the end of a bead: primes, pressure that falls.
struct FlowSpot {
    std::uint32_t bead = 0;
    bool at_end = false;  ///< of the bead; else at its start
    bool inside = false;  ///< the path goes on through this place
    double volume = 0;    ///< mm^3
    double time = 0;      ///< s
};

/// Volumes in mm^3. fed = laid + what is in the nozzle; laid is the sum of parts, spots and purges.
struct FlowRecord {
    std::vector<FlowPart> parts;  ///< in print order
    std::vector<FlowSpot> spots;  ///< likewise
    double fed = 0;               ///< that the extruder has moved at its furthest
    double laid = 0;
    double purged = 0;           ///< that flowed out where nothing is printed
    double fed_to_beads = 0;     ///< that the moves of beads state
    double filament_area = 0;    ///< mm^2, of the first bead
    double longest_advance = 0;  ///< s, the largest pressure advance in force
};

}  // namespace stratum::deposit
