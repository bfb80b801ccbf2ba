#include "march/file/whole_grid.h"

#include "base/parallel_for.h"
#include "march/file/leaf_file.h"
#include "march/file/vdb_check.h"
#include "march/file/vdb_walker.h"

#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

namespace stratum::march {
namespace {

constexpr std::size_t kLeavesAPart = 128;

/// Calls body(n) for all n below `count`, on all threads. Returns what the least n threw that threw anything: all
/// before it were called.
template <typename Body>
std::exception_ptr firstFailure(std::size_t count, std::size_t grain, const Body& body) {
    std::atomic<std::size_t> first_bad{count};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    parallelFor(count, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last && n < first_bad; ++n) {
            try {
                body(n);
            } catch (...) {
                const std::scoped_lock lock(failure_mutex);
                if (n >= first_bad) return;
                first_bad = n;
                failure = std::current_exception();
            }
        }
    });
    return failure;
}

// NaN is like itself, and the two zeros differ.
template <typename Value>
bool sameBits(const Value& a, const Value& b) {
    std::array<std::array<char, sizeof(Value)>, 2> bits;
    std::memcpy(bits[0].data(), &a, sizeof a);
    std::memcpy(bits[1].data(), &b, sizeof b);
    return bits[0] == bits[1];
}

/// Keeps the upper levels as they are in the file.
struct UpperLevels final : VdbTreeVisitor {
    struct Tile {
        openvdb::Coord origin;
        std::string_view value;
        bool active;
    };
    struct Lower {
        VdbNode node;
        std::size_t parent;      // of `uppers`
        std::size_t first_leaf;  // in the file's order
    };

    void background(std::string_view value) override { outside = value; }
    void tile(const openvdb::Coord& origin, std::string_view value, bool active) override {
        tiles.push_back({origin, value, active});
    }
    void upper(const VdbNode& node) override { uppers.push_back(node); }
    void lower(const VdbNode& node, std::string_view leaf_masks) override {
        lowers.push_back({node, uppers.size() - 1, leaves});
        masks.push_back(leaf_masks);
        leaves += leaf_masks.size() / kLeafMaskBytes;
    }

    std::string_view outside;
    std::vector<Tile> tiles;
    std::vector<VdbNode> uppers;
    std::vector<Lower> lowers;
    std::vector<std::string_view> masks;  // of the leaves below each of `lowers`
    std::size_t leaves = 0;
};

template <typename Grid>
class WholeGrid {
public:
    WholeGrid(const openvdb::GridBase& head, const VdbGrid& in_file, const VdbBytes& bytes, const std::string& where)
        : grid_(openvdb::gridPtrCast<Grid>(head.copyGridWithNewTree())),
          in_file_(in_file),
          format_(*valueFormatOf(in_file)),
          bytes_(bytes),
          where_(where) {}

    typename Grid::Ptr read() {
        VdbCursor cursor = cursorAt(in_file_.tree);
        walkVdbTree(cursor, format_, levels_);
        if (in_file_.listed && *in_file_.listed != levels_.leaves) cursor.fail("a list of other leaves");
        makeNodes();
        readLeaves(cursor.offset());
        return grid_;
    }

private:
    using Value = typename Grid::ValueType;
    using Upper = typename Grid::TreeType::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    using Leaf = typename Lower::ChildNodeType;

    VdbCursor cursorAt(std::uint64_t offset) const {
        VdbCursor cursor(bytes_, where_);
        cursor.moveTo(static_cast<std::int64_t>(offset));
        return cursor;
    }

    static Value valueOf(std::string_view bytes) {
        Value value;
        std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
        return value;
    }

    // All but the values of the leaves.
    void makeNodes() {
        auto& root = grid_->tree().root();
        background_ = valueOf(levels_.outside);
        root.setBackground(background_, /*updateChildNodes=*/false);
        for (const UpperLevels::Tile& tile : levels_.tiles) root.addTile(tile.origin, valueOf(tile.value), tile.active);
        std::vector<Upper*> uppers;
        for (const VdbNode& node : levels_.uppers) {
            auto upper = std::make_unique<Upper>(openvdb::PartialCreate(), node.origin, background_);
            takeTiles(node, *upper);
            uppers.push_back(upper.get());
            root.addChild(upper.release());
        }
        leaves_.resize(levels_.leaves);
        std::vector<std::unique_ptr<Lower>> lowers(levels_.lowers.size());
        if (const auto failure = firstFailure(lowers.size(), 1, [&](std::size_t n) { lowers[n] = makeLower(n); }))
            std::rethrow_exception(failure);
        for (std::size_t n = 0; n < lowers.size(); ++n) uppers[levels_.lowers[n].parent]->addChild(lowers[n].release());
    }

    // With its leaves, which have no values yet.
    std::unique_ptr<Lower> makeLower(std::size_t number) {
        const VdbNode& node = levels_.lowers[number].node;
        auto lower = std::make_unique<Lower>(openvdb::PartialCreate(), node.origin, background_);
        takeTiles(node, *lower);
        std::string_view masks = levels_.masks[number];
        std::size_t leaf_number = levels_.lowers[number].first_leaf;
        forEachOn(node.children, [&](std::size_t child) {
            auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), node.originOf(child), background_);
            typename Leaf::NodeMaskType mask;
            for (openvdb::Index word = 0; word < Leaf::NodeMaskType::WORD_COUNT; ++word)
                mask.template getWord<openvdb::Index64>(word) = wordOf(masks, word);
            leaf->setValueMask(mask);
            leaves_[leaf_number++] = {leaf.get(), masks.substr(0, kLeafMaskBytes)};
            masks.remove_prefix(kLeafMaskBytes);
            lower->addChild(leaf.release());
        });
        return lower;
    }

    template <typename Node>
    void takeTiles(const VdbNode& from, Node& node) const {
        std::vector<Value> values(Node::NUM_VALUES);
        unpackVdbValues(cursorAt(in_file_.tree), from.values, format_, from.active, background_, values.data());
        for (std::size_t word = 0; word < Node::NUM_VALUES / 64; ++word) {
            const std::uint64_t active = wordOf(from.active, word);
            for (std::uint64_t rest = ~wordOf(from.children, word); rest != 0; rest &= rest - 1) {
                const std::size_t tile = 64 * word + static_cast<std::size_t>(std::countr_zero(rest));
                const bool on = (active >> (tile & 63) & 1) != 0;
                // By their bits: a zero and a NaN have several. Most are as the node was made.
                if (on || !sameBits(values[tile], background_))
                    node.addTile(static_cast<openvdb::Index>(tile), values[tile], on);
            }
        }
    }

    void readLeaves(std::uint64_t first) {
        VdbCursor cursor = cursorAt(first);
        const auto listed = listedLeafPlaces(cursor, in_file_, format_, levels_.masks);
        std::exception_ptr failure;
        if (listed) failure = readLeavesAt(*listed);
        if (listed && !failure) return;
        // Without a list, or with one of other leaves: OpenVDB reads such a file one leaf after the other, too.
        const LeafPlaces walked = walkLeafPlaces(cursor, format_, levels_.masks);
        if (!listed || walked != *listed) failure = readLeavesAt(walked);
        if (failure) std::rethrow_exception(failure);
    }

    std::exception_ptr readLeavesAt(const LeafPlaces& places) {
        return firstFailure(leaves_.size(), kLeavesAPart, [&](std::size_t n) {
            const auto [leaf, mask] = leaves_[n];
            VdbCursor cursor = cursorAt(places[n]);
            const VdbValues values = walkVdbLeaf(cursor, format_, mask);
            if (cursor.offset() != places[n + 1]) cursor.fail("a list of other leaves");
            leaf->allocate();
            unpackVdbValues(cursor, values, format_, mask, background_, leaf->buffer().data());
        });
    }

    typename Grid::Ptr grid_;
    const VdbGrid& in_file_;
    VdbValueFormat format_;
    VdbBytes bytes_;
    const std::string& where_;
    UpperLevels levels_;
    Value background_{};
    struct LeafInFile {
        Leaf* leaf;
        std::string_view mask;
    };
    std::vector<LeafInFile> leaves_;  // in the file's order
};

template <typename Grid>
openvdb::GridBase::Ptr readAs(const openvdb::GridBase& head, const VdbGrid& in_file, const VdbBytes& bytes,
                              const std::string& where) {
    if (!head.isType<Grid>() || in_file.type != Grid::gridType()) return nullptr;
    return WholeGrid<Grid>(head, in_file, bytes, where).read();
}

}  // namespace

openvdb::GridBase::Ptr readWholeGrid(const VdbHeads& heads, const VdbGrid& grid, const openvdb::GridBase& head,
                                     const VdbBytes& bytes, const std::string& where) {
    const std::string name = openvdb::io::GridDescriptor::stripSuffix(grid.name);
    const auto of_the_name = std::count_if(heads.grids.begin(), heads.grids.end(), [&name](const VdbGrid& other) {
        return openvdb::io::GridDescriptor::stripSuffix(other.name) == name;
    });
    if (of_the_name == 1 && grid.parent.empty()) {
        openvdb::GridBase::Ptr read = readAs<openvdb::FloatGrid>(head, grid, bytes, where);
        if (!read) read = readAs<openvdb::Int32Grid>(head, grid, bytes, where);
        if (!read) read = readAs<openvdb::Vec3SGrid>(head, grid, bytes, where);
        if (read) {
            // Not the head's: a copy of a transform differs in its last bits.
            read->setTransform(transformOf(heads, grid));
            return read;
        }
    }
    checkVdb(bytes, VdbDepth::leaves, name, where);
    openvdb::io::File file(where);
    file.open(/*delayLoad=*/false);
    return file.readGrid(nameOf(grid));
}

}  // namespace stratum::march
