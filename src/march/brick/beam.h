// A small depth buffer for the rays of one eye: how much empty space before the first surface they can skip.
//
// After the beam optimization of Laine and Karras, "Efficient Sparse Voxel Octrees" (I3D 2010): rays are sorted by
// direction into small beams, and each beam gets a plane across the rays before which it meets nothing. Here the planes
// of all beams are found at once, as a rasterizer would: blocks of 4^3 cells with surface are projected, from near to
// far, until every beam has met one.
#pragma once

#include "march/brick/brick_grid.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::march {

/// Of rays from one eye that all move along the same axis. All in cells.
struct RayFan {
    glm::dvec3 eye{0.0};
    int main = 0;       ///< that axis; `across` are (main + 1) % 3 and (main + 2) % 3
    bool forth = true;  ///< whether the rays ascend along it
    /// Least and greatest slopes: cells across for a cell along the main axis.
    double low[2] = {0, 0}, high[2] = {0, 0};
};

/// Beams are the cells of a raster over the slopes of a fan.
class Beams {
public:
    static constexpr int kMostSide = 32;  ///< beams along each axis of slopes

    explicit Beams(const BrickGrid& grid) : grid_(grid) {}

    /// Chooses the raster for so many rays. No beam has rays yet.
    void begin(const RayFan& fan, std::size_t rays);
    /// Column (k = 0) or row (k = 1) of a slope is the integer below (slope - fan.low[k]) * scale(k).
    double scale(int k) const { return scale_[k]; }
    /// The beam at row * kMostSide + column has rays.
    void open(std::size_t row_and_column) { has_rays_[row_and_column] = 1; }
    /// Finds the planes of the beams that have rays.
    void findPlanes();
    /// By row * kMostSide + column: the plane across the main axis before which the beam meets no surface cell;
    /// infinite if it meets none at all. Counted along the way: its cell, or minus that where the rays descend.
    const double* planes() const { return planes_.data(); }

private:
    struct Box {
        std::array<int, 3> low, high;  // cells, inclusive
    };
    // Columns or rows of beams that each of a sequence of cubes is in: from the first to the last; none if the last is
    // before the first.
    struct Ranges {
        std::vector<int> first, last;
    };

    // Cells [from, to) of the main axis: how far along it the fan comes to them and leaves them, the inverses of both,
    // and a margin for rounding. The same for all blocks of a layer.
    struct Layer {
        Layer(const RayFan& fan, int from_cell, int to_cell);
        int from, to;
        double near, far, per_near, per_far, margin;
    };

    void openAll();
    bool shrink();
    bool cover(const Layer& layer, Box& box) const;
    void meetMacros(int slab);
    void meetBlocks(const Layer& layer, std::uint64_t among, int half);
    void project(const Layer& layer, const Box& box);
    void project(int k, const Layer& layer, int begin, int end, Ranges& ranges) const;
    void meetBricks(const MacroCell& macro, const std::array<int, 3>& corner, std::uint64_t among, int half,
                    double plane);
    bool anyOpen(int first_row, int last_row, std::uint32_t columns) const;
    void meet(int first_row, int last_row, std::uint32_t columns, double plane);

    const BrickGrid& grid_;
    RayFan fan_;
    double low_[2], high_[2];  // slopes of the beams that have met nothing yet
    int count_[2];             // columns and rows
    double scale_[2];
    // By row and column, a byte each: rays come in an order in which bits would wait for one another.
    std::array<std::uint8_t, std::size_t{kMostSide} * kMostSide> has_rays_;
    std::array<std::uint32_t, kMostSide> open_;  // by row, a bit for each column: beams that have met nothing yet
    std::array<double, std::size_t{kMostSide} * kMostSide> planes_;
    // Of a slab: macro cells with bricks, and their corners.
    struct Found {
        const MacroCell* macro;
        std::array<int, 3> corner;
    };
    std::vector<Found> found_;
    // Of the blocks of a layer, whose projection has two factors: which columns and rows they are in, by their place
    // along either axis across, from the block begin_ on.
    int begin_[2];
    Ranges column_range_, rows_;
    std::vector<std::uint32_t> columns_;  // a bit for each
};

}  // namespace stratum::march
