// Sums over a square of two by two cells, weighted by the tents of its nodes. In SIMD, with the same bytes on all
// instruction sets; see leaf_kernels.h.
#pragma once

#include "voxelize/leaf/leaf_kernels.h"
#include "voxelize/swell/swell_field.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stratum::voxelize {

constexpr int kSquareCells = 2;
constexpr int kSquareNodes = kSquareCells + 1;

/// By point, mm: what a layer holds, below 0, and what it gains as outlines move out by TileSums::kSwells.
struct PressedLayer {
    static constexpr std::size_t kFields = 1 + TileSums::kLevels;
    enum class Kind : std::uint8_t {
        nothing,  ///< even with outlines moved out; the fields are not set
        flat,     ///< flats at all points, which gain nothing; the fields are not set
        some,
    };
    Kind kind = Kind::nothing;
    std::array<PlanField, kFields> fields;  ///< in the order of TileSums::Node
    std::uint64_t solid = 0;                ///< bit c: point c has plastic
};

/// Of a section with that radius and straight sides of the height `straight`, mm. `sides2` as of LeafColumn.
/// `settling_scale`: LayerStack::settling_scale.
void pressLayer(const PlanField& sides2, float radius, float straight, double settling_scale, PressedLayer& out);

/// Adds the sums of nodes to a row of each kind.
void addNodes(std::span<const TileSums::Node> nodes, float* surplus, float* gain0, float* gain1, float* gain2);

/// 64 points of ColumnGrid::spread() over the square. Sums of up to four fields at once: tents weigh them, and the area
/// that a point stands for.
class NodeSums {
public:
    static constexpr std::size_t kFields = PressedLayer::kFields;
    static constexpr std::size_t kNodes = std::size_t{kSquareNodes} * kSquareNodes;
    using Sums = std::array<std::array<float, kFields>, kNodes>;  ///< by node, row by row

    /// `points`: in mm from the middle of the square.
    explicit NodeSums(const ColumnGrid& points);

    /// Adds to kFields values of each node: of kSquareNodes rows `stride` values apart.
    void add(const std::array<PlanField, kFields>& fields, float* nodes, std::size_t stride) const;
    Sums of(const std::array<PlanField, kFields>& fields) const;
    /// Of a field that is 1 at all points.
    float area(std::size_t node) const { return area_[node]; }

    /// A square's four cells, of 15 and 17 points: of a point the weights of the four corners of its cell, once for
    /// each field. The rest is 0.
    static constexpr std::size_t kCells = std::size_t{kSquareCells} * kSquareCells;
    static constexpr std::size_t kCellPoints = 17;
    static constexpr std::size_t kCorners = 4;
    struct alignas(64) Weights {
        float of[kCellPoints][kCells][kCorners * kFields];
        std::uint32_t point[kCellPoints][kCells];
    };

private:
    Weights weights_{};
    std::array<float, kNodes> area_{};
};

}  // namespace stratum::voxelize
