// Volume inside the cells of one leaf, and which leaves a sample takes.
#pragma once

#include <cstdint>

namespace stratum::voxelize {

/// A leaf's samples, by x, y and z, and the next ones along each axis.
struct LeafSamples {
    static constexpr int kEdge = 9;
    float v[kEdge][kEdge][kEdge];
};

/// Voxels of the first edge x edge x 8 cells that are inside. A cell of eight negative samples is solid; the share of a
/// mixed one is found from the zero crossings of four lines along z.
double insideCells(const LeafSamples& leaf, int edge);

/// A hash (splitmix64's last step): leaves are in a regular order, and every n-th would be a biased sample.
std::uint64_t scattered(std::uint64_t n);

}  // namespace stratum::voxelize
