// One stiff or extreme case: what is measured, how large it may be, and why just so large.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stratum::study {

/// Of beads in cases that don't depend on it, mm.
inline constexpr double kBeadWidth = 0.45, kBeadHeight = 0.2;

/// The bound of fields that are exact but for rounding, in words.
inline constexpr const char* kRoundings = "8 float roundings of the longest local length (leaf, band or half width)";

struct StabilityCase {
    std::string family;    ///< toolpath, grid, rays, light, motion, flow, shards or viewer
    std::string name;      ///< unique in its family
    std::string quantity;  ///< what is measured, with its unit
    double tolerance = 0;  ///< the largest value that passes
    std::string why;       ///< where the tolerance comes from, in a line
    /// Measures. 0 is perfect. A NaN, an exception, a crash or a hang fails the case.
    std::function<double()> measure;
};

std::vector<StabilityCase> toolpathCases();
std::vector<StabilityCase> gridCases();
std::vector<StabilityCase> rayCases();
std::vector<StabilityCase> lightCases();
std::vector<StabilityCase> motionCases();
std::vector<StabilityCase> flowCases();
std::vector<StabilityCase> shardCases();
std::vector<StabilityCase> viewerCases();

/// All of them, family by family.
std::vector<StabilityCase> stabilityCases();

/// "passed", or "failed"; a NaN has not passed.
std::string verdictOn(const StabilityCase& test, double measured);

}  // namespace stratum::study
