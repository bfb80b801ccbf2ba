// The rows of render.csv, variant by variant, and what the page tells of them.
#pragma once

#include "study/report/page.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace stratum::study {

/// Rows of one variant and number of samples, over its seeds.
struct RenderPoint {
    int spp = 0;
    double wall = 0, cpu = 0;      ///< medians, seconds
    double error = 0, spread = 0;  ///< mean relMSE, and its standard deviation over the seeds
    double fine = 0;               ///< mean relMSE against the finest voxels' reference
    double flip = 0, flip_spread = 0;
};

/// By variant, ascending by samples.
using RenderResults = std::map<std::string, std::vector<RenderPoint>>;
RenderResults renderResults(const Table& table);

/// What the voxels of one size do to a picture, beside those of the finest.
struct VoxelBias {
    int per_layer = 0;
    std::string variant;         ///< that has them
    double error = 0, flip = 0;  ///< of its reference against that of the finest
};

/// Plots of error and FLIP over time.
void addComparison(Page& page, const RenderResults& results, const char* title,
                   const std::vector<std::string>& variants);
/// The error of the voxels alone beside the noise. The finest is the last.
void addVoxels(Page& page, const RenderResults& results, const std::vector<VoxelBias>& sizes);
/// `variants`: their names, and those of their references.
void addSlopes(Page& page, const RenderResults& results,
               const std::vector<std::pair<std::string, std::string>>& variants);

}  // namespace stratum::study
