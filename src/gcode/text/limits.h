// Limits of plausible numbers: larger ones mean that a file is damaged, and are refused with their line.
#pragma once

namespace stratum::gcode {

constexpr double kMaxCoordinate = 1e5;  // mm: no printer is a hundred metres wide
constexpr double kMaxExtrusion = 1e6;   // mm or mm^3 in one move
constexpr double kMaxFilament = 100;    // mm of diameter
constexpr double kMaxFactor = 1e4;      // per cent, of flow and speed

}  // namespace stratum::gcode
