// The active voxels of a node's leaves, packed while they wait: the format has those of all leaves before the first
// value.
#pragma once

#include "export/leaf_packer.h"

#include <cstddef>
#include <ostream>
#include <span>
#include <vector>

namespace stratum::exporter {

class PackedMasks {
public:
    PackedMasks() = default;
    explicit PackedMasks(std::span<const LeafMask> masks);

    std::size_t size() const { return count_; }
    /// All of them, in their order, as LeafMask::save().
    void write(std::ostream& out) const;
    /// Memory, bytes.
    std::size_t bytes() const { return packed_.capacity(); }

private:
    std::size_t count_ = 0;
    std::vector<char> packed_;
};

}  // namespace stratum::exporter
