#include "export/level_set_output.h"

#include "base/error.h"

#include <blosc.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/io.h>

#include <memory>
#include <string>
#include <utility>

namespace stratum::exporter {

// Walls repeat their masks from leaf to leaf: LZ4 finds that at its lowest level, and bytes stay in their order.
PackedMasks::PackedMasks(std::span<const LeafMask> masks) : count_(masks.size()) {
    constexpr int kLevel = 1;
    if (masks.empty()) return;
    std::vector<char> room(masks.size_bytes() + BLOSC_MAX_OVERHEAD);
    const int bytes = blosc_compress_ctx(kLevel, BLOSC_NOSHUFFLE, 1, masks.size_bytes(), masks.data(), room.data(),
                                         room.size(), BLOSC_LZ4_COMPNAME, 0, 1);
    if (bytes <= 0) throw OutputError("Blosc can't pack the masks of leaves");
    packed_.assign(room.begin(), room.begin() + bytes);
}

void PackedMasks::write(std::ostream& out) const {
    if (count_ == 0) return;
    std::vector<char> masks(count_ * sizeof(LeafMask));
    if (blosc_decompress_ctx(packed_.data(), masks.data(), masks.size(), 1) != static_cast<int>(masks.size()))
        throw OutputError("Blosc can't unpack the masks of leaves");
    out.write(masks.data(), static_cast<std::streamsize>(masks.size()));
}

namespace {

using openvdb::Coord;
using openvdb::Index;
using Tree = openvdb::FloatTree;
using Upper = Tree::RootNodeType::ChildNodeType;
using Lower = Upper::ChildNodeType;

static_assert(Upper::LOG2DIM == 5 && Lower::LOG2DIM == 4, "the file format is that of this tree");

// What lies between children along z, then y, then x has the sign of the last voxel before it; before the first child
// that is the sign of its first voxel. There is at least one child.
template <typename Mask>
EndSigns floodTiles(const Mask& children, const std::vector<EndSigns>& signs, Mask& inside) {
    constexpr Index kEdge = Mask::DIM;
    bool in_x = signs.front().first;
    bool in_y = in_x;
    bool in_z = in_x;
    Index next = 0;  // child
    EndSigns ends;
    // The children that begin a row, or a plane of rows, are passed in order.
    for (Index x = 0; x < kEdge; ++x) {
        for (Index y = 0; y < kEdge; ++y) {
            for (Index z = 0; z < kEdge; ++z) {
                const Index n = (x * kEdge + y) * kEdge + z;
                const bool child = children.isOn(n);
                if (z == 0) {
                    if (y == 0) {
                        if (child) in_x = signs[next].last;
                        in_y = in_x;
                    }
                    if (child) in_y = signs[next].last;
                    in_z = in_y;
                }
                if (n == 0) ends.first = child ? signs[next].first : in_z;
                if (child) {
                    in_z = signs[next].last;
                    ++next;
                } else if (in_z) {
                    inside.setOn(n);
                }
                ends.last = in_z;
            }
        }
    }
    return ends;
}

template <typename Mask>
void writeNode(std::ostream& out, const Mask& children, const Mask& inside, float background, bool half) {
    children.save(out);
    Mask().save(out);  // no tile is active
    auto values = std::make_unique<float[]>(Mask::SIZE);
    for (Index n = 0; n < Mask::SIZE; ++n) values[n] = children.isOn(n) ? 0 : inside.isOn(n) ? -background : background;
    openvdb::io::writeCompressedValues(out, values.get(), Mask::SIZE, Mask(), children, half);
}

Coord upperOf(const Coord& origin) {
    constexpr int kMask = ~(static_cast<int>(Upper::DIM) - 1);
    return {origin[0] & kMask, origin[1] & kMask, origin[2] & kMask};
}

}  // namespace

void LowerNode::flood(const std::vector<EndSigns>& signs) { ends = floodTiles(children, signs, inside); }

void LevelSetNodes::add(LowerNode&& node) {
    const Coord origin = upperOf(node.origin);
    if (upper_.empty() || upper_.back().origin != origin) {
        upper_.emplace_back();
        upper_.back().origin = origin;
        upper_.back().first_lower = lower_.size();
    }
    upper_.back().children.setOn(Upper::coordToOffset(node.origin));
    leaves_ += node.leaves.size();
    lower_.push_back(std::move(node));
}

void LevelSetNodes::flood() {
    for (std::size_t n = 0; n < upper_.size(); ++n) {
        UpperNode& upper = upper_[n];
        std::vector<EndSigns> signs;
        const std::size_t last = n + 1 < upper_.size() ? upper_[n + 1].first_lower : lower_.size();
        for (std::size_t k = upper.first_lower; k < last; ++k) signs.push_back(lower_[k].ends);
        upper.ends = floodTiles(upper.children, signs, upper.inside);
    }
    // Upper nodes with only inside between them along z.
    constexpr int kEdge = static_cast<int>(Upper::DIM);
    for (std::size_t n = 1; n < upper_.size(); ++n) {
        const UpperNode& low = upper_[n - 1];
        const UpperNode& high = upper_[n];
        if (low.origin[0] != high.origin[0] || low.origin[1] != high.origin[1]) continue;
        if (!low.ends.last || !high.ends.first) continue;
        for (int z = low.origin[2] + kEdge; z < high.origin[2]; z += kEdge)
            inside_tiles_.emplace_back(low.origin[0], low.origin[1], z);
    }
}

std::size_t LevelSetNodes::memoryBytes() const {
    // What one more node of each kind adds.
    Tree tree(1.0F);
    const auto with = [&tree](int x) {
        tree.touchLeaf({x, 0, 0});
        return static_cast<std::size_t>(tree.memUsage());
    };
    const auto root = static_cast<std::size_t>(tree.memUsage());
    const std::size_t chain = with(0) - root;
    const std::size_t leaf = with(8) - root - chain;
    const std::size_t lower = with(128) - root - chain - 2 * leaf;
    const std::size_t upper = chain - leaf - lower;
    return root + leaves_ * leaf + lower_.size() * lower + upper_.size() * upper;
}

void LevelSetNodes::write(std::ostream& out, float background, bool half, bool masks) const {
    const auto number = [&out](auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
    // Tree and RootNode
    number(std::int32_t{1});  // one buffer a leaf
    const float stored = half ? openvdb::io::truncateRealToHalf(background) : background;
    number(stored);
    openvdb::io::setGridBackgroundValuePtr(out, &background);
    number(static_cast<std::uint32_t>(inside_tiles_.size()));
    number(static_cast<std::uint32_t>(upper_.size()));
    const auto place = [&](const Coord& origin) {
        for (int axis = 0; axis < 3; ++axis) number(std::int32_t{origin[axis]});
    };
    for (const Coord& tile : inside_tiles_) {
        place(tile);
        number(-background);
        number(false);
    }
    for (std::size_t n = 0; n < upper_.size(); ++n) {
        place(upper_[n].origin);
        writeNode(out, upper_[n].children, upper_[n].inside, background, half);
        const std::size_t last = n + 1 < upper_.size() ? upper_[n + 1].first_lower : lower_.size();
        for (std::size_t k = upper_[n].first_lower; k < last; ++k) {
            writeNode(out, lower_[k].children, lower_[k].inside, background, half);
            if (masks) lower_[k].leaves.write(out);
        }
    }
    openvdb::io::setGridBackgroundValuePtr(out, nullptr);
}

std::size_t LevelSetNodes::writtenBytes(const LeafFormat& format, float background) const {
    std::vector<char> nodes;
    PackingStream stream(format, nullptr, nodes);
    write(stream, background, format.half, false);
    return nodes.size() + leaves_ * sizeof(LeafMask);
}

std::size_t LevelSetNodes::mostBytes(const LeafFormat& format, std::size_t leaves, std::size_t lower_nodes,
                                     std::size_t upper_nodes) {
    // Two masks; and a third, which tells inside from outside, or all values: a quarter more for what packs badly.
    const bool active_only = (format.compression & openvdb::io::COMPRESS_ACTIVE_MASK) != 0;
    const auto node = [&](std::size_t values) { return 64 + values / 4 + (active_only ? values / 8 : values * 5); };
    constexpr std::size_t kOrigin = 3 * sizeof(std::int32_t);
    return 64 + leaves * sizeof(LeafMask) + lower_nodes * node(LowerMask::SIZE) +
           upper_nodes * (node(UpperMask::SIZE) + kOrigin);
}

namespace {

// One part in so many of a file may be room that is left; of more the leaves are moved, which then are few.
constexpr std::uint64_t kMostSpare = 100;

}  // namespace

LevelSetOutput::LevelSetOutput(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path,
                               std::uint32_t compression, const voxelize::NodeBounds& bounds)
    : output_(path),
      file_(output_.temporary(), path),
      archive_(compression),
      grid_(std::move(grid)),
      format_(archive_.formatOf(*grid_)),
      list_(format_) {
    // Statistics have their final size already.
    insertStatistics(*grid_, {}, format_);
    places_.head = archive_.header(1, {}).size();
    places_.leaves = places_.head + headBytes(archive_, *grid_, grid_->getName(), LeafList::mostBytes(bounds.leaves)) +
                     LevelSetNodes::mostBytes(format_, bounds.leaves, bounds.lower_nodes, bounds.upper_nodes);
    places_.end = places_.leaves;
}

void LevelSetOutput::append(std::span<iovec> leaves) {
    std::uint64_t bytes = 0;
    for (const iovec& piece : leaves) bytes += piece.iov_len;
    file_.write(places_.end, leaves);
    file_.startFlush(places_.end, places_.end + bytes);
    places_.end += bytes;
}

void LevelSetOutput::count(std::size_t active_voxels, const openvdb::CoordBBox& active_box) {
    statistics_.active_voxels += active_voxels;
    statistics_.active_box.expand(active_box);
}

WrittenGrid LevelSetOutput::finish() {
    nodes_.flood();
    statistics_.memory_bytes = nodes_.memoryBytes();
    insertStatistics(*grid_, statistics_, format_);
    const float background = grid_->background();
    const std::string listed = list_.bytes();
    const std::uint64_t nodes = nodes_.writtenBytes(format_, background);
    const std::uint64_t needed = headBytes(archive_, *grid_, grid_->getName(), listed.size()) + nodes;
    // Without leaves there is no list to take the room that is left.
    const std::uint64_t spare = places_.leaves - places_.head - needed;
    if (listed.empty() || kMostSpare * spare > places_.end - spare) {
        file_.moveForward(places_.leaves, places_.end, spare);
        places_.leaves -= spare;
        places_.end -= spare;
    }
    // The topology ends where the leaves begin.
    places_.topology = places_.leaves - nodes;
    PositionedStream topology(file_, places_.topology);
    openvdb::io::setDataCompression(topology, format_.compression);
    nodes_.write(topology, background, format_.half);
    topology.writeOut();
    writeHead(file_, archive_, *grid_, grid_->getName(), places_, listed);
    file_.write(0, archive_.header(1, identityOf(*grid_, listed)));
    file_.finish(places_.end);
    output_.commit();
    return {statistics_, nodes_.leafCount()};
}

}  // namespace stratum::exporter
