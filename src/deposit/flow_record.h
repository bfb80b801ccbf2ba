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

/// A round thread thinner than this is not laid: a string breaks there, mm. A choice.
constexpr double kThinnestThread = 0.05;

/// A straight piece of a string: what oozes on a travel through air.
struct FlowString {
    std::uint32_t bead = 0;                 ///< after which it is laid
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< mm
    double z = 0;                           ///< mm, of the nozzle at the end of that bead
    double volume = 0;                      ///< mm^3
    double start = 0;                       ///< s
    double seconds = 0;                     ///< that it takes
    double from = 0, to = 0;                ///< mm of the string, in the plan
    double span = 0;                        ///< mm, its length if both ends are held; 0: it ends in the air
};

/// Volumes in mm^3. fed = laid + what is in the nozzle; laid is the sum of parts, spots, strings and purges.
struct FlowRecord {
    std::vector<FlowPart> parts;      ///< in print order
    std::vector<FlowSpot> spots;      ///< likewise
    std::vector<FlowString> strings;  ///< likewise; none unless they were asked for
    double fed = 0;                   ///< that the extruder has moved at its furthest
    double laid = 0;
    double purged = 0;           ///< that flowed out where nothing is printed
    double fed_to_beads = 0;     ///< that the moves of beads state
    double filament_area = 0;    ///< mm^2, of the first bead
    double longest_advance = 0;  ///< s, the largest pressure advance in force
};

}  // namespace stratum::deposit
