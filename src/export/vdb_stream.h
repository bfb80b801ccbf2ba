// Leaves of a print -> .vdb, without a grid: the level set goes to the disk while it is made.
#pragma once

#include "base/parallel_for.h"
#include "export/level_set_output.h"
#include "export/vdb_file.h"
#include "voxelize/grid/leaf_receiver.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::exporter {

// Memory for many short pieces of bytes that are forgotten together.

/// Pieces stay where they are until clear(), which keeps the memory for the next ones: fresh pages are slow, and
/// vectors that double take twice what they hold.
class ByteArena {
public:
    std::string_view keep(std::span<const char> piece) {
        if (piece.size() > kChunk - used_) next();
        char* const at = chunks_[current_ - 1].get() + used_;
        std::memcpy(at, piece.data(), piece.size());
        used_ += piece.size();
        return {at, piece.size()};
    }
    void clear() {
        current_ = 0;
        used_ = kChunk;
    }
    /// The largest piece.
    static constexpr std::size_t kChunk = std::size_t{1} << 18;

private:
    void next() {
        if (current_ == chunks_.size()) chunks_.push_back(std::make_unique_for_overwrite<char[]>(kChunk));
        ++current_;
        used_ = 0;
    }

    std::vector<std::unique_ptr<char[]>> chunks_;
    std::size_t current_ = 0;    // chunks in use
    std::size_t used_ = kChunk;  // bytes of the last of them
};

/// Writes one level set. Leaves are packed by the threads that make them; a block of them is in memory while it is
/// made, another one while it is written, and about 20 bytes of every leaf until the end. OpenVDB reads the file to the
/// grid that Voxelizer::printAll() makes; the bytes of tree and leaves are those of its own writer, behind metadata
/// with the unused bytes that vdb_archive.h tells of. Errors throw OutputError, and the old file stays.
class VdbStream : public voxelize::LeafReceiver {
public:
    /// `grid`: Voxelizer::emptyGrid() with the metadata of describe(). `bounds`: of the leaves that will come.
    VdbStream(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path, const FileOptions& options,
              const voxelize::NodeBounds& bounds);

    void open(const openvdb::Coord& origin) override;
    void leaf(std::size_t column, const openvdb::Coord& origin, const float* values,
              const std::uint64_t* active) override;
    void workOnClosed() override;
    void close() override;

    /// All leaves have come: the file gets its head and its name.
    WrittenGrid finish();

private:
    struct Leaf {
        int z = 0;  // voxels
        std::string_view bytes;
        PackedLeaf packed;
        EndSigns signs;
        LeafMask active;
    };
    struct Column {
        std::vector<Leaf> leaves;
        std::size_t active_voxels = 0;
        openvdb::CoordBBox active_box;
    };
    struct Block {
        openvdb::Coord origin;
        bool any = false;
        std::vector<Column> columns{voxelize::kBlockColumns};
        PerThread<ByteArena> bytes;  // of the leaves
    };

    void writeBlock(Block& block);

    const float background_;
    LevelSetOutput output_;
    PerThread<std::vector<char>> packing_;  // of one leaf
    Block open_, closed_;
};

}  // namespace stratum::exporter
