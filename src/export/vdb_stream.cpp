#include "export/vdb_stream.h"

#include <bit>
#include <cstring>
#include <utility>

namespace stratum::exporter {
namespace {

constexpr int kLowerVoxels = 128;
constexpr int kLeafVoxels = 8;

// The box of a leaf's active voxels: bits of a word are y and z, words are x.
openvdb::CoordBBox activeBox(const openvdb::Coord& origin, const LeafMask& active) {
    std::uint32_t in_x = 0;
    std::uint64_t any = 0;
    for (openvdb::Index32 x = 0; x < LeafMask::WORD_COUNT; ++x) {
        const std::uint64_t plane = active.getWord<std::uint64_t>(x);
        any |= plane;
        in_x |= (plane != 0 ? 1U : 0U) << x;
    }
    std::uint64_t in_z = any | any >> 32;
    in_z |= in_z >> 16;
    in_z |= in_z >> 8;
    const auto z = static_cast<std::uint32_t>(in_z & 0xffU);
    const auto first = [](auto bits) { return std::countr_zero(bits); };
    const auto last = [](auto bits) { return std::bit_width(bits) - 1; };
    return {origin.offsetBy(first(in_x), first(any) / kLeafVoxels, first(z)),
            origin.offsetBy(static_cast<int>(last(in_x)), static_cast<int>(last(any)) / kLeafVoxels,
                            static_cast<int>(last(z)))};
}

// Leaves of one column mostly lie one behind the other.
void append(std::string_view bytes, std::vector<iovec>& parts) {
    char* const first = const_cast<char*>(bytes.data());  // pwritev() only reads
    if (!parts.empty() && static_cast<char*>(parts.back().iov_base) + parts.back().iov_len == first)
        parts.back().iov_len += bytes.size();
    else
        parts.push_back({first, bytes.size()});
}

}  // namespace

VdbStream::VdbStream(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path, const FileOptions& options,
                     const voxelize::NodeBounds& bounds)
    : background_(grid->background()), output_([&] {
          grid->setSaveFloatAsHalf(options.half);
          return LevelSetOutput(std::move(grid), path, compressionFlags(options.compression), bounds);
      }()) {}

void VdbStream::open(const openvdb::Coord& origin) {
    open_.origin = origin;
    open_.any = true;
}

void VdbStream::leaf(std::size_t column, const openvdb::Coord& origin, const float* values,
                     const std::uint64_t* active) {
    Column& to = open_.columns[column];
    Leaf& leaf = to.leaves.emplace_back();
    leaf.z = origin[2];
    std::memcpy(&leaf.active.getWord<std::uint64_t>(0), active, sizeof leaf.active);
    std::vector<char>& packing = packing_.local();
    packing.clear();
    leaf.packed = packClampedLeaf(output_.format(), values, leaf.active, background_, packing);
    leaf.bytes = open_.bytes.local().keep(packing);
    leaf.signs = {values[0] < 0, values[LeafMask::SIZE - 1] < 0};
    to.active_voxels += leaf.active.countOn();
    to.active_box.expand(activeBox(origin, leaf.active));
}

void VdbStream::close() { std::swap(open_, closed_); }

void VdbStream::workOnClosed() {
    if (!closed_.any) return;
    writeBlock(closed_);
    closed_.any = false;
}

// The leaves of a lower node are those of its columns, one column after the other.
void VdbStream::writeBlock(Block& block) {
    std::vector<std::size_t> next(block.columns.size());  // leaf, by column
    std::vector<iovec> parts;
    std::vector<EndSigns> signs;
    std::vector<LeafMask> masks;
    for (int z = block.origin[2]; z < block.origin[2] + voxelize::kSlabVoxels; z += kLowerVoxels) {
        LowerNode node;
        node.origin = {block.origin[0], block.origin[1], z};
        signs.clear();
        masks.clear();
        for (std::size_t c = 0; c < block.columns.size(); ++c) {
            Column& column = block.columns[c];
            for (; next[c] < column.leaves.size() && column.leaves[next[c]].z < z + kLowerVoxels; ++next[c]) {
                const Leaf& leaf = column.leaves[next[c]];
                node.children.setOn(static_cast<openvdb::Index>(c) * LowerMask::DIM +
                                    static_cast<openvdb::Index>((leaf.z - z) / kLeafVoxels));
                masks.push_back(leaf.active);
                signs.push_back(leaf.signs);
                output_.add(leaf.packed);
                append(leaf.bytes, parts);
            }
        }
        if (signs.empty()) continue;
        node.leaves = PackedMasks(masks);
        node.flood(signs);
        output_.add(std::move(node));
    }
    output_.append(parts);
    for (Column& column : block.columns) {
        output_.count(column.active_voxels, column.active_box);
        column.active_voxels = 0;
        column.active_box.reset();
        column.leaves.clear();
    }
    for (ByteArena& arena : block.bytes) arena.clear();
}

WrittenGrid VdbStream::finish() {
    workOnClosed();
    for (Block* block : {&open_, &closed_}) block->bytes.clear();
    return output_.finish();
}

}  // namespace stratum::exporter
