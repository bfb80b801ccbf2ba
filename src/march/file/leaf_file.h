// A level set that stays in its .vdb file: each leaf is read when it is asked for, from any thread.
//
// OpenVDB's own delayed loading builds the whole tree first and then opens a stream a leaf, behind a lock. This reads
// the upper levels of the tree alone (a thousandth of the file) and finds the leaves by arithmetic.
#pragma once

#include "base/input_file.h"
#include "march/file/leaf_source.h"
#include "march/file/vdb_walker.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::march {

// The values of a node's tiles: nearly always the background, outside and inside.

/// Of one or two different values a bit a tile is kept, or nothing; else all.
class TileValues {
public:
    TileValues() = default;
    explicit TileValues(std::span<const float> values) {
        if (values.empty()) return;
        one_ = other_ = values.front();
        for (const float value : values) {
            if (same(value, one_) || same(value, other_)) continue;
            if (!same(one_, other_)) {
                all_.assign(values.begin(), values.end());
                return;
            }
            other_ = value;
        }
        if (same(one_, other_)) return;
        others_.resize((values.size() + 63) / 64);
        for (std::size_t n = 0; n < values.size(); ++n)
            if (same(values[n], other_)) others_[n / 64] |= std::uint64_t{1} << (n % 64);
    }

    float operator[](std::size_t tile) const {
        if (!all_.empty()) return all_[tile];
        return !others_.empty() && (others_[tile / 64] >> (tile % 64) & 1) != 0 ? other_ : one_;
    }
    std::size_t bytes() const {
        return sizeof(*this) + all_.capacity() * sizeof(float) + others_.capacity() * sizeof(std::uint64_t);
    }

private:
    static bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

    float one_ = 0, other_ = 0;
    std::vector<std::uint64_t> others_;  // a bit for each tile that has the other value
    std::vector<float> all_;
};

// Where the leaves of a tree are in a .vdb.

/// Offsets of the leaves' values, in the file's order, and where the last one ends: one more than leaves.
using LeafPlaces = std::vector<std::uint64_t>;

/// By the sizes that the file lists (io::DelayedLoadMetadata), without touching the leaves. Nothing if it has no such
/// list, or one that does not end where the grid ends.
/// @param cursor  at the first leaf
/// @param masks  of the leaves below each lower node, as VdbTreeVisitor has them
std::optional<LeafPlaces> listedLeafPlaces(const VdbCursor& cursor, const VdbGrid& grid, const VdbValueFormat& format,
                                           const std::vector<std::string_view>& masks);

/// By walking through all leaves. Throws InputError unless they are whole and have the masks of the upper levels; what
/// is packed is not unpacked.
/// @param cursor  at the first leaf, afterwards behind the last
LeafPlaces walkLeafPlaces(VdbCursor& cursor, const VdbValueFormat& format, const std::vector<std::string_view>& masks);

/// The values of the leaf at the cursor, which moves behind them. Throws InputError unless it has this mask, which
/// OpenVDB counts its values by: masks are in the file twice.
VdbValues walkVdbLeaf(VdbCursor& cursor, const VdbValueFormat& format, std::string_view mask);

class LeafFile final : public LeafSource {
public:
    /// Opens the grid of that name, which must be the only one of the name; its samples are floats, its metadata was
    /// read before. Returns null for an instance of another grid. Throws InputError for a missing or damaged file.
    static std::shared_ptr<const LeafFile> open(InputFile input, const std::string& name,
                                                const openvdb::MetaMap& metadata);

    /// Metadata, transform, background, and no voxels.
    const openvdb::FloatGrid& head() const { return *head_; }
    /// Index-space box of the active voxels.
    openvdb::CoordBBox activeBox() const;
    /// As the file says, or counted.
    std::uint64_t activeVoxelCount() const;

    std::size_t leafCount() const override { return leaves_.size(); }
    openvdb::Coord origin(std::size_t leaf) const override { return leaves_[leaf].origin; }
    const float* samples(std::size_t leaf, float* scratch) const override;
    float tile(const openvdb::Coord& at) const override;
    float background() const override { return head_->background(); }
    std::string name() const override { return head_->getName(); }

private:
    struct Leaf {
        openvdb::Coord origin;
        std::uint64_t offset;  // of its values in the file, bytes
    };
    class TreeReader;

    explicit LeafFile(InputFile input) : file_(std::move(input)), where_(file_.path().string()) {}
    VdbCursor cursorAt(std::uint64_t offset) const;
    void placeLeaves(std::uint64_t first, std::uint64_t end, const VdbGrid& grid,
                     const std::vector<std::string_view>& masks);
    std::string_view activeOf(const Leaf& leaf) const;

    InputFile file_;
    openvdb::FloatGrid::Ptr head_;
    std::string where_, name_;  // for messages
    VdbValueFormat format_{sizeof(float)};
    std::vector<Leaf> leaves_;  // in the file's order
    openvdb::CoordBBox active_tiles_;
    std::map<openvdb::Coord, float> root_tiles_;
    std::map<openvdb::Coord, TileValues> upper_, lower_;  // of nodes with 32^3 and 16^3 children
};

}  // namespace stratum::march
