// The inner loops of the voxelizer, in SIMD: plan fields of a leaf column, and their expansion into a leaf.
//
// Through Highway, for the best instruction set of the machine, chosen at run time. Every operation is one that IEEE
// 754 rounds exactly (no fused multiply-add, no estimate), so all instruction sets give the same bytes.
//
// A column has 64 samples, x * 8 + y as in a leaf; q is a sample relative to the middle of the column. A leaf is kept
// as eight planes of 64, plane by plane in z, until it is stored; optionally the plane above it is evaluated as well.
// World units throughout.
#pragma once

#include "voxelize/beads/local_path.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::voxelize {

constexpr std::size_t kColumnSamples = 64;
constexpr std::size_t kLeafPlanes = 8;
constexpr std::size_t kMostPlanes = kLeafPlanes + 1;

/// 64 values of a column.
struct alignas(64) PlanField {
    float v[kColumnSamples];
};

/// 512 values of a leaf, plane by plane, and optionally the plane above it.
struct alignas(64) LeafPlanes {
    PlanField plane[kMostPlanes];
};

/// 64 bead ranks.
struct alignas(64) PlanOwners {
    std::uint32_t v[kColumnSamples];
};

/// Where the samples of a column lie.
struct ColumnGrid {
    PlanField qx, qy;
    /// `voxel` in world units.
    explicit ColumnGrid(float voxel);
    /// 64 points of a lattice rule instead, spread evenly over the square from the first sample of the column to the
    /// first of the next: lines in few directions meet two of them at once, so sums over them are near integrals.
    static ColumnGrid spread(float voxel);
};

/// d = min(d, rho - half_flat) for each path. `owners`, if not null, gets `ids[n]` where path n is nearer than before.
void minimumOfLines(const ColumnGrid& grid, std::span<const LocalLine> lines, PlanField& d, const std::uint32_t* ids,
                    PlanOwners* owners);
void minimumOfArcs(const ColumnGrid& grid, std::span<const LocalArc> arcs, PlanField& d, const std::uint32_t* ids,
                   PlanOwners* owners);
/// The same of paths whose half flat changes.
void minimumOfTapers(const ColumnGrid& grid, std::span<const LocalTaper> tapers, PlanField& d, const std::uint32_t* ids,
                     PlanOwners* owners);

/// out = max(d, 0)^2; returns the least of it.
float squaredSides(const PlanField& d, PlanField& out);
/// out = max(a, b); returns the least of it.
float maximumOf(const PlanField& a, const PlanField& b, PlanField& out);

/// One layer's part in one plane of a leaf.
struct PlaneTerm {
    const PlanField* sides2 = nullptr;
    float dz2 = 0;                 ///< squared height over the layer's center plane, or over its straight sides
    const PlanField* d = nullptr;  ///< only with straight sides
    float over = 0;                ///< height over the straight sides, negative beside them
    /// If not null, what is above the center plane is moved up by this, or down where it is negative, by half at most.
    /// Of `dz`, the height over the center plane, dz2 and over follow then.
    const PlanField* rise = nullptr;
    float dz = 0;
};
/// Layers of one section: terms first..last - 1 take one root together.
struct PlaneTerms {
    std::uint32_t first, last;
    float radius;
    bool straight_sides = false;
    bool rises = false;   ///< some of its terms
    float half_side = 0;  ///< half the height of the straight sides; only where it rises
};
/// The body that closes the plane between two touching layers: max(d, bound), used where it is negative. `bound` must
/// be negative.
struct PlaneWeldTerm {
    const PlanField* d = nullptr;
    float bound = 0;
};
/// The terms of all layers in a leaf. Plane z has groups group_end[z - 1]..group_end[z] - 1 and welds likewise, from 0.
struct LeafTerms {
    std::size_t planes = kLeafPlanes;  ///< or kMostPlanes
    std::vector<PlaneTerm> terms;
    std::vector<PlaneTerms> groups;
    std::vector<PlaneWeldTerm> welds;
    std::uint32_t group_end[kMostPlanes] = {};
    std::uint32_t weld_end[kMostPlanes] = {};

    void clear() {
        terms.clear();
        groups.clear();
        welds.clear();
    }
};
/// phi = min over groups (sqrt(min over terms (sides2 + dz2)) - radius) and welds, or `background` without any terms.
/// Groups with straight sides add min over terms (max(d, over)) where that is negative.
void expandLayers(const LeafTerms& leaf, float background, LeafPlanes& phi);

/// A sloped bead over a column: d = rho - half_flat, and the height of its center line.
void slopedLine(const ColumnGrid& grid, const LocalLine& line, float z0, float climb_per_unit, PlanField& d,
                PlanField& center_z);
/// up = (z - center_z) cosine, lowered by reach below; phi = min(phi, sqrt(sides2 + up^2) - radius), sides2 as of
/// squaredSides().
struct SlopedTerm {
    float cosine, reach, radius, half_side;
};
void expandSloped(const PlanField& sides2, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi);
/// The same with straight sides, by d itself.
void expandSlopedSides(const PlanField& d, const PlanField& center_z, const SlopedTerm& term, float z, PlanField& phi);

/// A straight round bead in 3-D. Perpendicular distances a = n0 + n.q in the plan, b = b0 + bx qx + by qy + bz z, and
/// s = ux qx + uy qy + uz z along it with the segment at lo <= s <= hi.
struct LocalRod {
    float nx, ny, n0;
    float bx, by, bz, b0;
    float ux, uy, uz, lo, hi;
    float radius;
};
void expandRod(const ColumnGrid& grid, const LocalRod& rod, float z, PlanField& phi);

/// The contents of a finished leaf.
enum class LeafContent : std::uint8_t { outside, inside, surface };

/// Clamps that many planes to +-background and returns their contents. Surface: some value is strictly within the
/// background.
LeafContent clampLeaf(LeafPlanes& phi, std::size_t planes, float background);
/// Writes the leaf's planes in leaf order (z fastest).
void storeLeaf(const LeafPlanes& phi, float* values);

/// The 8 words of the mask of values strictly within the background, in leaf order.
void maskWithin(const float* values, float background, std::uint64_t* mask);

/// The 8 words of the mask of values of `least` or more, in leaf order.
void maskFrom(const float* values, float least, std::uint64_t* mask);

/// The instruction set in use; for tests and reports.
const char* kernelTarget();

}  // namespace stratum::voxelize
