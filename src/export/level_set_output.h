// A .vdb file of one level set whose leaves come packed, in the file's order: what is before them is written last.
#pragma once

#include "base/atomic_file.h"
#include "export/leaf_packer.h"
#include "export/positioned_file.h"
#include "export/vdb_archive.h"
#include "voxelize/grid/leaf_stream.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <ostream>
#include <span>
#include <vector>

namespace stratum::exporter {

// The active voxels of a node's leaves, packed while they wait: the format has those of all leaves before the first
// value.

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

// The internal nodes of a level set's tree, without its leaves: what a .vdb file says before them.

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

/// What was written of a grid; of an openvdb::FloatGrid the same would be counted.
struct WrittenGrid {
    GridStatistics statistics;
    std::size_t leaves = 0;
};

/// The same grid, bounds, leaves and nodes make the same bytes, wherever they come from. Errors throw OutputError, and
/// the old file stays.
class LevelSetOutput {
public:
    /// `compression`: openvdb::io::COMPRESS_*. `bounds`: no more will come.
    LevelSetOutput(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path, std::uint32_t compression,
                   const voxelize::NodeBounds& bounds);

    const LeafFormat& format() const { return format_; }
    /// The next leaf of the list.
    void add(PackedLeaf leaf) { list_.add(leaf); }
    /// The next lower node; its leaves are the next ones of those added.
    void add(LowerNode&& node) { nodes_.add(std::move(node)); }
    /// The next bytes of leaves; changes the list.
    void append(std::span<iovec> leaves);
    /// More voxels, for the statistics.
    void count(std::size_t active_voxels, const openvdb::CoordBBox& active_box);
    /// All have come: the file gets its head and its name.
    WrittenGrid finish();

private:
    AtomicFile output_;
    PositionedFile file_;
    VdbArchive archive_;
    openvdb::FloatGrid::Ptr grid_;
    LeafFormat format_;
    LeafList list_;
    LevelSetNodes nodes_;
    GridStatistics statistics_;
    GridPlaces places_;
};

}  // namespace stratum::exporter
