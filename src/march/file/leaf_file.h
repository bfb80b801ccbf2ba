// A level set that stays in its .vdb file: each leaf is read when it is asked for, from any thread.
//
// OpenVDB's own delayed loading builds the whole tree first and then opens a stream a leaf, behind a lock. This reads
// the upper levels of the tree alone (a thousandth of the file) and finds the leaves by arithmetic.
#pragma once

#include "base/input_file.h"
#include "march/file/leaf_source.h"
#include "march/file/tile_values.h"
#include "march/file/vdb_walker.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::march {

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
