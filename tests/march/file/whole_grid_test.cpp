#include "march/file/whole_grid.h"

#include "base/error.h"
#include "march/file/vdb_check.h"
#include "march/file/vdb_walker.h"
#include "refusal.h"
#include "rubble.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <openvdb/io/DelayedLoadMetadata.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace stratum::march {
namespace {

namespace fs = std::filesystem;
namespace io = openvdb::io;

template <typename T>
bool sameBits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// Plain loops: a check of the test framework for each of millions of tiles would take longer than all reading.
template <typename Node>
bool sameNode(const Node& a, const Node& b) {
    if (a.origin() != b.origin() || a.getValueMask() != b.getValueMask()) return false;
    if constexpr (Node::LEVEL == 0) {
        return std::memcmp(a.buffer().data(), b.buffer().data(), Node::SIZE * sizeof(typename Node::ValueType)) == 0;
    } else {
        if (a.getChildMask() != b.getChildMask()) return false;
        for (openvdb::Index n = 0; n < Node::NUM_VALUES; ++n)
            if (a.getChildMask().isOff(n) && !sameBits(a.getTable()[n].getValue(), b.getTable()[n].getValue()))
                return false;
        return true;
    }
}

template <typename Node, typename Tree>
void expectSameLevel(const Tree& a, const Tree& b) {
    std::vector<const Node*> of_a;
    std::vector<const Node*> of_b;
    a.getNodes(of_a);
    b.getNodes(of_b);
    ASSERT_EQ(of_a.size(), of_b.size());
    for (std::size_t n = 0; n < of_a.size(); ++n) ASSERT_TRUE(sameNode(*of_a[n], *of_b[n])) << of_b[n]->origin();
}

// The tree to the last bit, with the masks of all levels, metadata and transform.
template <typename Grid>
void expectSame(const openvdb::GridBase& read, const openvdb::GridBase& expected) {
    ASSERT_EQ(read.type(), expected.type());
    EXPECT_TRUE(static_cast<const openvdb::MetaMap&>(read) == static_cast<const openvdb::MetaMap&>(expected));
    EXPECT_EQ(read.transform().mapType(), expected.transform().mapType());
    for (const openvdb::Vec3d& p : {openvdb::Vec3d(0, 0, 0), openvdb::Vec3d(41, 42.1, -43.7)}) {
        EXPECT_TRUE(sameBits(read.indexToWorld(p), expected.indexToWorld(p)));
        EXPECT_TRUE(sameBits(read.worldToIndex(p), expected.worldToIndex(p)));
        EXPECT_TRUE(sameBits(read.transform().baseMap()->applyIJT(p), expected.transform().baseMap()->applyIJT(p)));
    }
    EXPECT_EQ(read.getName(), expected.getName());
    EXPECT_EQ(read.saveFloatAsHalf(), expected.saveFloatAsHalf());
    const auto& a = static_cast<const Grid&>(read).tree();
    const auto& b = static_cast<const Grid&>(expected).tree();
    EXPECT_TRUE(sameBits(a.background(), b.background()));
    const auto tilesOf = [](const auto& tree) {
        std::map<openvdb::Coord, std::pair<typename Grid::ValueType, bool>> tiles;
        for (auto tile = tree.root().cbeginValueAll(); tile; ++tile) tiles[tile.getCoord()] = {*tile, tile.isValueOn()};
        return tiles;
    };
    EXPECT_EQ(tilesOf(a), tilesOf(b));
    using Upper = typename Grid::TreeType::RootNodeType::ChildNodeType;
    expectSameLevel<Upper>(a, b);
    expectSameLevel<typename Upper::ChildNodeType>(a, b);
    expectSameLevel<typename Grid::TreeType::LeafNodeType>(a, b);
}

class WholeGrid : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    test::ScratchFolder folder_;
    const fs::path path_ = folder_ / "grids.vdb";

    void write(const openvdb::GridCPtrVec& grids, std::uint32_t compression, bool listed = true) const {
        // OpenVDB lists the leaves' sizes if it knows the type of the list.
        if (!listed) io::DelayedLoadMetadata::unregisterType();
        io::File file(path_.string());
        file.setCompression(compression);
        file.write(grids);
        file.close();
        if (!listed) io::DelayedLoadMetadata::registerType();
    }

    std::string bytes() const { return test::bytesOf(path_); }
    void overwrite(const std::string& bytes) const { test::writeText(path_, bytes); }

    openvdb::GridBase::Ptr read(const std::string& name) const {
        const std::string all = bytes();
        const std::string where = path_.string();
        VdbCursor cursor(std::string_view(all), where);
        const VdbHeads heads = walkVdbHeads(cursor);
        for (const VdbGrid& grid : heads.grids)
            if (nameOf(grid) == name)
                return readWholeGrid(heads, grid, *headOf(heads, grid), std::string_view(all), where);
        throw InputError("no grid " + name);
    }
    openvdb::GridBase::Ptr readByOpenVdb(const std::string& name) const {
        const std::string all = bytes();
        io::File file(path_.string());
        file.open(/*delayLoad=*/false);
        checkVdb(std::string_view(all), VdbDepth::leaves, name, path_.string());
        return file.readGrid(name);
    }
    std::string refusal(const std::string& name) const {
        return test::messageOf<InputError>([&] { (void)read(name); });
    }

    // Spheres of many leaves, tiles of all levels, and leaves of every kind of inactive values.
    static openvdb::FloatGrid::Ptr allKinds(const char* name) {
        auto grid = test::rubble(0.2F, true);
        grid->setName(name);
        grid->setTransform(openvdb::math::Transform::createLinearTransform(0.2));
        grid->transform().postTranslate(openvdb::Vec3d(1, 2, 3));
        grid->insertMeta("note", openvdb::StringMetadata("kept"));
        auto& tree = grid->tree();
        tree.addTile(1, openvdb::Coord(800, 0, 0), -0.1F, false);
        tree.addTile(1, openvdb::Coord(-800, 8, 16), 0.05F, true);
        tree.addTile(1, openvdb::Coord(-808, 8, 16), grid->background(), true);
        tree.addTile(1, openvdb::Coord(808, 8, 16), std::numeric_limits<float>::quiet_NaN(), true);
        tree.addTile(2, openvdb::Coord(0, 1024, 0), -0.15F, false);
        tree.addTile(2, openvdb::Coord(0, 1152, 0), -0.0F, false);
        tree.addTile(3, openvdb::Coord(8192, 0, 0), -0.02F, false);
        tree.addTile(3, openvdb::Coord(-8192, 0, 0), -0.02F, true);
        const float outside = grid->background();
        const std::vector<std::vector<float>> kinds = {
            {outside},           {-outside},        {0.125F},         {outside, -outside},
            {-outside, outside}, {0.125F, outside}, {0.125F, -0.25F}, {0.125F, -0.25F, -0.0F}};
        for (int actives : {0, 1, 7, 512})
            for (std::size_t kind = 0; kind < kinds.size(); ++kind)
                for (int n = 0; n < 512; ++n) {
                    const openvdb::Coord at(2048 + 8 * static_cast<int>(kind) + n / 64, 8 * actives + n / 8 % 8, n % 8);
                    if (n % 512 < actives)
                        tree.setValueOn(at, 0.0002F * static_cast<float>(n));
                    else
                        tree.setValueOff(at, kinds[kind][static_cast<std::size_t>(n) % kinds[kind].size()]);
                }
        return grid;
    }

    template <typename Grid, typename ValueOf>
    static typename Grid::Ptr attribute(const char* name, const typename Grid::ValueType& outside,
                                        const ValueOf& valueOf) {
        auto grid = Grid::create(outside);
        grid->setName(name);
        const auto surface = test::rubble(0.2F, false);
        for (auto i = surface->cbeginValueOn(); i; ++i)
            if (i.isVoxelValue()) grid->tree().setValueOn(i.getCoord(), valueOf(i.getCoord()));
        grid->tree().addTile(2, openvdb::Coord(0, 1024, 0), valueOf(openvdb::Coord(1, 2, 3)), true);
        grid->tree().setValueOff(openvdb::Coord(0, 0, 0), valueOf(openvdb::Coord(7, 7, 7)));
        return grid;
    }
};

constexpr std::uint32_t kZipped = io::COMPRESS_ZIP, kActive = io::COMPRESS_ACTIVE_MASK, kPacked = io::COMPRESS_BLOSC;

TEST_F(WholeGrid, IsWhatOpenVdbReads) {
    const auto surface = allKinds("surface");
    const auto half = surface->deepCopy();
    half->setName("half");
    half->setSaveFloatAsHalf(true);
    // OpenVDB never zips level sets.
    const auto unclassed = surface->deepCopy();
    unclassed->setName("unclassed");
    unclassed->setGridClass(openvdb::GRID_UNKNOWN);
    const auto unclassed_half = half->deepCopy();
    unclassed_half->setName("unclassed_half");
    unclassed_half->setGridClass(openvdb::GRID_UNKNOWN);
    const auto layer = attribute<openvdb::Int32Grid>("layer", -7, [](const openvdb::Coord& at) { return at[2]; });
    const auto color = attribute<openvdb::Vec3SGrid>(
        "color", openvdb::Vec3f(-1, 2, 0), [](const openvdb::Coord& at) { return openvdb::Vec3f(at.asVec3s()); });
    const auto half_color = color->deepCopy();
    half_color->setName("half_color");
    half_color->setSaveFloatAsHalf(true);
    const auto empty = openvdb::FloatGrid::create(0.5F);
    empty->setName("empty");
    const auto twin = surface->copy();
    twin->setName("twin");
    std::vector<std::uint32_t> compressions = {kActive | kPacked};
#if !defined(STRATUM_THREAD_SANITIZER)  // threads meet in the same way in all of them
    compressions.insert(compressions.end(),
                        {kActive | kZipped, kActive | kZipped | kPacked, kActive, kPacked, kZipped, 0U});
#endif
    for (const bool listed : {true, false})
        for (const std::uint32_t compression : compressions) {
            SCOPED_TRACE(testing::Message() << "compression " << compression << (listed ? " listed" : " not listed"));
            write({surface, half, unclassed, unclassed_half, layer, color, half_color, empty, twin}, compression,
                  listed);
            for (const char* name : {"surface", "half", "unclassed", "unclassed_half", "empty", "twin"}) {
                SCOPED_TRACE(name);
                expectSame<openvdb::FloatGrid>(*read(name), *readByOpenVdb(name));
            }
            expectSame<openvdb::Int32Grid>(*read("layer"), *readByOpenVdb("layer"));
            for (const char* name : {"color", "half_color"})
                expectSame<openvdb::Vec3SGrid>(*read(name), *readByOpenVdb(name));
        }
}

TEST_F(WholeGrid, IsTheSameWithAnyNumberOfLeaves) {
    for (int leaves = 1; leaves <= 140; leaves += leaves < 20 ? 1 : 17) {
        auto grid = openvdb::FloatGrid::create(0.3F);
        grid->setName("surface");
        for (int n = 0; n < leaves; ++n) grid->tree().setValue(openvdb::Coord(8 * n, 0, 0), 0.1F);
        write({grid}, kActive | kPacked);
        expectSame<openvdb::FloatGrid>(*read("surface"), *readByOpenVdb("surface"));
    }
}

// Grids of one name are told apart by numbers.
TEST_F(WholeGrid, OfTwoOfOneName) {
    const auto first = test::rubble(0.2F, false);
    const auto second = test::rubble(0.1F, false);
    write({first, second}, kActive | kPacked);
    for (const char* name : {"surface[0]", "surface[1]"})
        expectSame<openvdb::FloatGrid>(*read(name), *readByOpenVdb(name));
}

// Two sizes of the list changed for one another: it still ends where the grid ends.
TEST_F(WholeGrid, DoesNotBelieveTheListOfSizes) {
    auto grid = openvdb::FloatGrid::create(0.3F);
    grid->setName("surface");
    for (int leaf = 0; leaf < 5; ++leaf)
        for (int n = 0; n <= 20 * leaf; ++n)
            grid->tree().setValue(openvdb::Coord(8 * leaf + n / 64, n / 8 % 8, n % 8), 0.001F * static_cast<float>(n));
    write({grid}, kActive | kPacked);
    std::string all = bytes();
    const std::string where = "a.vdb";
    VdbCursor cursor(std::string_view(all), where);
    const VdbGrid in_file = walkVdbHeads(cursor).grids.at(0);
    ASSERT_EQ(in_file.listed, 5U);
    // Their number of bytes and of leaves, the masks with their length, the length of the sizes.
    const std::size_t sizes = static_cast<std::size_t>(in_file.sizes.data() - all.data()) + 4 + 4 + 4 + 5 + 4;
    std::swap_ranges(all.begin() + static_cast<std::ptrdiff_t>(sizes),
                     all.begin() + static_cast<std::ptrdiff_t>(sizes + 8),
                     all.begin() + static_cast<std::ptrdiff_t>(sizes + 32));
    ASSERT_NE(all, bytes());
    overwrite(all);
    expectSame<openvdb::FloatGrid>(*read("surface"), *readByOpenVdb("surface"));
}

// Changed bytes anywhere are refused where OpenVDB and the check before it refuse them, and else read as OpenVDB does.
TEST_F(WholeGrid, RefusesWhatOpenVdbRefuses) {
    std::mt19937 random(17);
    int refused = 0;
    for (const std::uint32_t compression : {kActive | kPacked, kActive | kZipped, kActive}) {
        const auto grid = test::rubble(0.2F, false);
        grid->setGridClass(openvdb::GRID_UNKNOWN);
        if (compression == kActive) grid->setSaveFloatAsHalf(true);
        write({grid}, compression);
        const std::string good = bytes();
        const auto tree = good.find("ScaleMap");
        for (int n = 0; n < 100; ++n) {
            std::string bad = good;
            for (int k = 0; k < 1 + n % 4; ++k)
                bad[tree + random() % (bad.size() - tree)] = static_cast<char>(random());
            overwrite(bad);
            openvdb::GridBase::Ptr expected;
            try {
                expected = readByOpenVdb("surface");
            } catch (const std::exception&) {
            }
            openvdb::GridBase::Ptr made;
            try {
                made = read("surface");
            } catch (const std::exception&) {
                ++refused;
            }
            if (expected && !made) {
                // OpenVDB takes zipped values whose checksum is wrong.
                ASSERT_TRUE((compression & kZipped) != 0 && refusal("surface").find("packed data") != std::string::npos)
                    << compression << " " << n << refusal("surface");
                continue;
            }
            ASSERT_EQ(made != nullptr, expected != nullptr) << compression << " " << n;
            if (made) expectSame<openvdb::FloatGrid>(*made, *expected);
        }
    }
    EXPECT_GT(refused, 40);
}

// Of several damages it is the first in the file that is told, whatever thread meets which first.
TEST_F(WholeGrid, TellsTheFirstDamage) {
    for (const bool listed : {true, false}) {
        write({test::rubble(0.1F, false)}, kActive | kPacked, listed);
        std::string bad = bytes();
        const std::string where = path_.string();
        VdbCursor cursor(std::string_view(bad), where);
        const VdbGrid in_file = walkVdbHeads(cursor).grids.at(0);
        const auto first = static_cast<std::size_t>(in_file.leaves);
        const std::size_t length = static_cast<std::size_t>(in_file.end) - first;
        for (std::size_t share = 3; share < 30; ++share)
            std::fill_n(bad.begin() + static_cast<std::ptrdiff_t>(first + length * share / 30), 2000, '\x55');
        overwrite(bad);
        const std::string text = refusal("surface");
        EXPECT_NE(text.find("is not a readable .vdb file"), std::string::npos) << text;
        for (int n = 0; n < 20; ++n) EXPECT_EQ(refusal("surface"), text);
    }
}

TEST_F(WholeGrid, RefusesEveryCut) {
    write({test::rubble(0.1F, false)}, kActive | kPacked);
    const std::string good = bytes();
    const std::string where = "a.vdb";
    VdbCursor cursor(std::string_view(good), where);
    const VdbHeads heads = walkVdbHeads(cursor);
    const auto tree = static_cast<std::size_t>(heads.grids.at(0).tree);
    const auto head = headOf(heads, heads.grids[0]);
    for (int n = 0; n < 40; ++n) {
        const std::size_t cut = tree + (good.size() - tree) * static_cast<std::size_t>(n) / 40;
        EXPECT_THROW(readWholeGrid(heads, heads.grids[0], *head, std::string_view(good).substr(0, cut), where),
                     InputError)
            << n;
    }
}

}  // namespace
}  // namespace stratum::march
