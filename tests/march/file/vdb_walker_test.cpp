#include "march/file/vdb_walker.h"

#include "base/error.h"
#include "rubble.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <map>

namespace stratum::march {
namespace {

// Files as OpenVDB writes them; vdb_check_test.cpp has those that are damaged.
class VdbWalker : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    test::ScratchFolder folder_;
    const std::string where_ = "a.vdb";

    std::string bytesOf(const openvdb::GridCPtrVec& grids, std::uint32_t compression) const {
        const std::filesystem::path path = folder_ / "grids.vdb";
        openvdb::io::File file(path.string());
        file.setCompression(compression);
        file.write(grids);
        file.close();
        return test::bytesOf(path);
    }
};

// What a visitor is told.
struct Seen : VdbTreeVisitor {
    std::string outside;
    std::map<openvdb::Coord, bool> tiles;
    std::vector<openvdb::Coord> leaves;
    std::uint64_t active_voxels = 0;

    void background(std::string_view value) override { outside = value; }
    void tile(const openvdb::Coord& origin, std::string_view /*value*/, bool active) override {
        tiles[origin] = active;
    }
    void lower(const VdbNode& node, std::string_view leaf_masks) override {
        forEachOn(node.children, [&](std::size_t child) { leaves.push_back(node.originOf(child)); });
        active_voxels += countOn(leaf_masks);
    }
};

TEST_F(VdbWalker, SeesWhatOpenVdbWrites) {
    const auto grid = test::rubble(0.05F, true);
    grid->tree().addTile(3, openvdb::Coord(8192, 0, 0), -0.02F, true);
    const auto half = grid->deepCopy();
    half->setName("half");
    half->setSaveFloatAsHalf(true);
    namespace io = openvdb::io;
    for (const std::uint32_t compression :
         {0U, unsigned{io::COMPRESS_ACTIVE_MASK}, unsigned{io::COMPRESS_ACTIVE_MASK} | unsigned{io::COMPRESS_BLOSC}}) {
        const std::string bytes = bytesOf({grid, half}, compression);
        VdbCursor cursor(std::string_view(bytes), where_);
        const VdbHeads heads = walkVdbHeads(cursor);
        EXPECT_EQ(heads.format, openvdb::OPENVDB_FILE_VERSION);
        ASSERT_EQ(heads.grids.size(), 2U);
        EXPECT_EQ(heads.grids[0].name, "surface");
        EXPECT_EQ(heads.grids[1].name, "half");
        for (const VdbGrid& head : heads.grids) {
            EXPECT_EQ(head.type, openvdb::FloatGrid::gridType());
            EXPECT_EQ(head.half, head.name == "half");
            EXPECT_EQ(head.parent, "");
            const VdbValueFormat format{4, head.half ? 2U : 0U, head.compression};
            cursor.moveTo(static_cast<std::int64_t>(head.tree));
            Seen seen;
            walkVdbTree(cursor, format, seen);
            EXPECT_EQ(cursor.offset(), static_cast<std::uint64_t>(head.leaves));
            EXPECT_EQ(seen.outside.size(), 4U);
            EXPECT_EQ(seen.tiles, (std::map<openvdb::Coord, bool>{{openvdb::Coord(8192, 0, 0), true}}));
            ASSERT_EQ(seen.leaves.size(), grid->tree().leafCount());
            for (const openvdb::Coord& leaf : seen.leaves)
                ASSERT_NE(grid->tree().probeConstLeaf(leaf), nullptr) << leaf;
            EXPECT_EQ(seen.active_voxels, grid->tree().activeLeafVoxelCount());
            for (std::size_t n = 0; n < seen.leaves.size(); ++n)
                (void)walkVdbValues(cursor, format, cursor.take(kLeafMaskBytes));
            EXPECT_EQ(cursor.offset(), static_cast<std::uint64_t>(head.end));
        }
    }
}

TEST_F(VdbWalker, NamesTheDamagedGrid) {
    const std::string bytes(10, '\0');
    const std::string grid = "surface";
    try {
        VdbCursor(std::string_view(bytes), where_, &grid).take(11);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "a.vdb: is not a readable .vdb file (the grid surface is damaged about byte 0); is it cut short?");
    }
    EXPECT_THROW(VdbCursor(std::string_view(bytes), where_).moveTo(11), InputError);
}

}  // namespace
}  // namespace stratum::march
