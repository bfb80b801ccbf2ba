// The seam between a level set that nobody has sampled yet and its bricks: samples are made where rays come.
#pragma once

#include "march/file/leaf_source.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stratum::march {

/// Which bricks may have surface, in macro cells of 4^3 bricks of 8^3 cells.
struct BrickMap {
    openvdb::Coord origin;             ///< index space: multiples of 32
    std::array<int, 3> macros{};       ///< macro cells along x, y and z
    std::vector<std::uint64_t> masks;  ///< of each, a Mask64 of its bricks; x slowest, z fastest
};

/// Samples in world units: of a leaf, x slowest, z fastest, and of the plane above it, x slowest. The bricks below a
/// leaf need no more of it than that plane, and where samples are made it costs an eighth of the leaf.
struct FieldSamples {
    alignas(64) std::array<float, LeafSource::kLeafSamples> leaf;
    alignas(64) std::array<float, LeafSource::kCapSamples> above;
};

/// A level set that can be sampled anywhere, a leaf of 8^3 at a time, and knows roughly where its surface is. Immutable
/// while rays are traced, and safe to ask from several threads.
class LeafField {
public:
    virtual ~LeafField() = default;
    /// Every brick with a surface cell is among these, others may be. Its box is that of the leaves with active voxels,
    /// widened to macro cells, so that rays are clipped as in a grid.
    virtual const BrickMap& bricks() const = 0;
    /// Whether anything of this macro cell of bricks() may be there as the field is now; see BrickGrid::update().
    virtual bool shows(std::size_t macro) const {
        (void)macro;
        return true;
    }
    /// The samples of the leaf from this index-space coordinate (multiples of 8). False if all of them are
    /// `background()`; then they are not written.
    virtual bool samples(const openvdb::Coord& origin, FieldSamples& out) const = 0;
    /// What is beyond the narrow band outside, world units.
    virtual float background() const = 0;
    virtual const openvdb::math::Transform& transform() const = 0;
    /// Index-space box of the samples within the narrow band.
    virtual openvdb::CoordBBox activeBox() const = 0;
    /// To begin messages with.
    virtual std::string name() const = 0;
    /// Memory taken, bytes.
    virtual std::size_t bytes() const = 0;
};

}  // namespace stratum::march
