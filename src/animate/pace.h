// How far a film's motion is at each frame: evenly, or with a slow begin and end.
#pragma once

#include <cstddef>
#include <vector>

namespace stratum::animate {

/// The share of a way at a share of its time. The speed rises evenly during the first `ease` of the time, and falls
/// evenly during the last; between them it is constant.
/// @param share  in [0, 1]
/// @param ease   in [0, 0.5]; 0: as fast at both ends as between them
double paced(double share, double ease);

/// The share of a print at each frame of a film: grown at frame `frames` - `held`, and whole from there on.
/// @param held  fewer than frames
std::vector<double> growthShares(std::size_t frames, std::size_t held, double ease);

}  // namespace stratum::animate
