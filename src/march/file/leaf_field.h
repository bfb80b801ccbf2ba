// The interface of a level set whose samples are computed when rays need them.
#pragma once

#include "march/file/leaf_source.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace stratum::march {

/// The bricks that may have surface, in macro cells of 4^3 bricks of 8^3 cells.
struct BrickMap {
    openvdb::Coord origin;             ///< index space: multiples of 32
    std::array<int, 3> macros{};       ///< macro cells along x, y and z
    std::vector<std::uint64_t> masks;  ///< by macro cell, x slowest, z fastest: a Mask64 of its bricks
};

/// Samples in world units: of a leaf, x slowest, z fastest, and of the plane above it, x slowest. A brick needs only
/// that plane of the leaf above, which costs an eighth of computing the leaf.
struct FieldSamples {
    alignas(64) std::array<float, LeafSource::kLeafSamples> leaf;
    alignas(64) std::array<float, LeafSource::kCapSamples> above;
};

/// A level set that can be sampled anywhere, a leaf of 8^3 at a time, with a conservative map of its surface. Immutable
/// while rays are traced; shared by all threads.
class LeafField {
public:
    virtual ~LeafField() = default;
    /// A superset of the bricks with surface cells. Its box is that of the leaves with active voxels, extended to macro
    /// cells, so that rays are clipped as in a grid.
    virtual const BrickMap& bricks() const = 0;
    /// Whether this macro cell of bricks() may have surface in the field's current state; see BrickGrid::update().
    virtual bool shows(std::size_t macro) const {
        (void)macro;
        return true;
    }
    /// The samples of the leaf from this index-space coordinate (multiples of 8). False if all of them are
    /// `background()`; then they are not written.
    virtual bool samples(const openvdb::Coord& origin, FieldSamples& out) const = 0;
    /// The value outside the narrow band, world units.
    virtual float background() const = 0;
    /// How nearly the samples are distances, world units: one that is farther from zero than some length and this, has
    /// the sign of all samples within that length. Infinite if no bound is known.
    virtual double signSlack() const { return std::numeric_limits<double>::infinity(); }
    virtual const openvdb::math::Transform& transform() const = 0;
    /// Index-space box of the samples within the narrow band.
    virtual openvdb::CoordBBox activeBox() const = 0;
    /// The name in messages.
    virtual std::string name() const = 0;
    /// Memory taken, bytes.
    virtual std::size_t bytes() const = 0;
};

}  // namespace stratum::march
