// A .vdb file of one level set whose leaves come packed, in the file's order: what is before them is written last.
#pragma once

#include "base/atomic_file.h"
#include "export/level_set_nodes.h"
#include "export/positioned_file.h"
#include "export/vdb_archive.h"
#include "voxelize/grid/leaf_stream.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace stratum::exporter {

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
