// The interface between a level set and its bricks: samples by leaf.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <string>
#include <vector>

namespace stratum::march {

/// The leaves of a level set: cubes of 8^3 samples at multiples of 8 in index space. Immutable; shared by all threads.
class LeafSource {
public:
    static constexpr int kLeafEdge = 8;
    static constexpr std::size_t kLeafSamples = 512;
    static constexpr std::size_t kCapSamples = 64;  ///< of one plane

    virtual ~LeafSource() = default;
    virtual std::size_t leafCount() const = 0;
    /// Index-space coordinate of a leaf's first sample.
    virtual openvdb::Coord origin(std::size_t leaf) const = 0;
    /// Its samples in world units, x slowest, z fastest: in memory of the source, or written to `scratch`, which has
    /// room for kLeafSamples. Throws InputError for one that can't be read.
    virtual const float* samples(std::size_t leaf, float* scratch) const = 0;
    /// The sample at a position outside all leaves.
    virtual float tile(const openvdb::Coord& at) const = 0;
    /// The value outside the narrow band, world units.
    virtual float background() const = 0;
    /// The name in messages.
    virtual std::string name() const = 0;
};

/// The leaves of a grid in memory, which must outlive this.
class GridLeaves final : public LeafSource {
public:
    explicit GridLeaves(const openvdb::FloatGrid& grid) : grid_(grid) {
        leaves_.reserve(grid.tree().leafCount());
        grid.tree().getNodes(leaves_);
    }
    std::size_t leafCount() const override { return leaves_.size(); }
    openvdb::Coord origin(std::size_t leaf) const override { return leaves_[leaf]->origin(); }
    const float* samples(std::size_t leaf, float*) const override { return leaves_[leaf]->buffer().data(); }
    float tile(const openvdb::Coord& at) const override { return grid_.tree().getValue(at); }
    float background() const override { return grid_.background(); }
    std::string name() const override { return grid_.getName(); }

private:
    const openvdb::FloatGrid& grid_;
    std::vector<const openvdb::FloatTree::LeafNodeType*> leaves_;
};

}  // namespace stratum::march
