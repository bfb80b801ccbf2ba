// Small programs that the study of deposition prints, in the words of PrusaSlicer.
#pragma once

#include <string>

namespace stratum::study {

/// The tile of docs/deposit.md and bench/volco.py: two layers of twelve lines, 0.45 x 0.2 mm, at the spacing of the
/// slicers, 10 mm long.
struct Tile {
    static constexpr double kWidth = 0.45, kHeight = 0.2, kLength = 10;  // mm
    static constexpr int kLines = 12, kLayers = 2;
};
/// `crossed`: the second layer across the first.
std::string tileProgram(bool crossed);
/// mm^3 that all lines of the tile are fed.
double tileFed();

/// A wall of one line a layer, 8 mm long, not along the axes, in pieces of 1 mm; sections of this width (mm) as
/// stadiums times `flow`.
std::string wallProgram(double height, double width, double flow, int layers);

/// An L of two lines of 30 mm, 0.2 mm high and 0.45 mm wide, at 60 mm/s and 1000 mm/s^2, with its corner at kCornerAt;
/// `jerk` (mm/s) is the change of speed that the machine allows there.
inline constexpr double kCornerAt = 40, kCornerWidth = 0.45, kCornerHeight = 0.2;
std::string cornerProgram(double jerk);

}  // namespace stratum::study
