// Beams of rays from one eye: finds how much empty space before the first brick they can skip together.
//
// After the beam optimization of Laine and Karras, "Efficient Sparse Voxel Octrees" (I3D 2010): the rays of a stream
// are sorted by direction into small beams, and each beam advances from slab to slab until it contains a brick.
#pragma once

#include "march/brick/brick_walk.h"
#include "trace/intersector.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace stratum::march {

class Beams {
public:
    /// The most rays of one call.
    static constexpr std::size_t kMostRays = 1024;

    Beams(const BrickGrid& grid, const CellMap& map) : grid_(grid), map_(map) {}
    /// For up to kMostRays rays. If they have one origin and similar directions, returns for each a t before which it
    /// reaches no brick, at least a cell's width before the first one; infinite if it reaches none. Empty otherwise.
    /// Valid until the next call.
    std::span<const double> starts(std::span<const trace::Ray> rays);

private:
    static constexpr int kSide = 4;  // beams along each axis of directions

    // Slopes of rays against their main axis.
    struct Bounds {
        double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    };
    double firstPlane(const Bounds& slopes) const;
    bool occupied(const int (&low)[3], const int (&high)[3]) const;

    const BrickGrid& grid_;
    const CellMap& map_;
    int main_ = 0;
    bool forth_ = true;
    glm::dvec3 eye_{0.0};
    std::array<std::array<double, kMostRays>, 3> slope_;  // of the other two axes, and 1 / d of the main one
    std::array<std::uint8_t, kMostRays> beam_;
    std::array<double, kMostRays> start_;
};

}  // namespace stratum::march
