// Takes the leaves of a print while they are made, in the order of a .vdb file.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>

namespace stratum::voxelize {

/// Columns of leaves in a block, 16 x 16.
constexpr std::size_t kBlockColumns = 256;
constexpr int kBlockVoxels = 128;  ///< along x and y: an edge of OpenVDB's lower internal nodes
constexpr int kSlabVoxels = 4096;  ///< along z: an edge of its upper ones

/// Leaves come in blocks: those in one pile of OpenVDB's lower internal nodes (128^3 voxels), inside one upper node
/// (4096^3). Upper nodes are in the order of their origins (x, then y, then z), the blocks of one by x, then y.
class LeafReceiver {
public:
    virtual ~LeafReceiver() = default;

    /// The next block, whose first voxel is this.
    virtual void open(const openvdb::Coord& origin) = 0;
    /// A leaf of the open block with at least one active voxel. Inactive ones have plus or minus the background. Called
    /// by several threads; the leaves of one column, number 16 x + y in the block, come from one thread, from the
    /// lowest.
    virtual void leaf(std::size_t column, const openvdb::Coord& origin, const float* values,
                      const std::uint64_t* active) = 0;
    /// Time to work on the blocks before: called by one thread while others call leaf().
    virtual void workOnClosed() = 0;
    /// All leaves of the open block have come.
    virtual void close() = 0;
};

}  // namespace stratum::voxelize
