// The internal nodes of a level set's tree, without its leaves: what a .vdb file says before them.
#pragma once

#include "export/leaf_packer.h"
#include "export/packed_masks.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <deque>
#include <ostream>
#include <vector>

namespace stratum::exporter {

using LowerMask = openvdb::util::NodeMask<4>;
using UpperMask = openvdb::util::NodeMask<5>;

/// Whether the first and the last voxel of a node are inside.
struct EndSigns {
    bool first = false, last = false;
};

/// 128^3 voxels.
struct LowerNode {
    openvdb::Coord origin;
    LowerMask children;
    LowerMask inside;  ///< of the tiles between the leaves
    EndSigns ends;
    PackedMasks leaves;  ///< active voxels, in the order of the children

    /// Sets `inside` and `ends`; `signs` are those of the leaves. As tools::signedFloodFill().
    void flood(const std::vector<EndSigns>& signs);
};

class LevelSetNodes {
public:
    /// In the order of LeafReceiver; with at least one leaf each.
    void add(LowerNode&& node);
    /// All have come: upper nodes and tiles of the root get their signs.
    void flood();

    std::size_t leafCount() const { return leaves_; }
    /// Bytes of an openvdb::FloatGrid of these nodes and leaves, as its memUsage().
    std::size_t memoryBytes() const;

    /// As FloatTree::writeTopology(). The stream must know the compression. `masks`: without them the masks of the
    /// leaves are left out.
    void write(std::ostream& out, float background, bool half, bool masks = true) const;
    /// The bytes of that.
    std::size_t writtenBytes(const LeafFormat& format, float background) const;
    /// No nodes of that many leaves take more.
    static std::size_t mostBytes(const LeafFormat& format, std::size_t leaves, std::size_t lower_nodes,
                                 std::size_t upper_nodes);

private:
    struct UpperNode {
        openvdb::Coord origin;
        UpperMask children, inside;
        EndSigns ends;
        std::size_t first_lower = 0;
    };

    std::deque<LowerNode> lower_;  // which moves none of them when it grows
    std::vector<UpperNode> upper_;
    std::vector<openvdb::Coord> inside_tiles_;  // of the root
    std::size_t leaves_ = 0;
};

}  // namespace stratum::exporter
