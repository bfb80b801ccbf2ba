#include "assemble/file/file_facts.h"

#include "base/error.h"
#include "prints.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

#include <gtest/gtest.h>

namespace stratum::assemble {
namespace {

TEST(FileFacts, TellsAGridFromOtherFiles) {
    const test::ScratchFolder scratch;
    EXPECT_TRUE(isVdbFile(test::writeSphere(scratch / "a.vdb").string()));
    test::writeText(scratch / "b.vdb", "G1 X1");
    EXPECT_FALSE(isVdbFile((scratch / "b.vdb").string()));
    EXPECT_FALSE(isVdbFile("-"));
    test::writeText(scratch / "c.vdb", "");
    EXPECT_THROW((void)isVdbFile((scratch / "c.vdb").string()), InputError);
    EXPECT_THROW((void)isVdbFile((scratch / "d.vdb").string()), InputError);
}

TEST(FileFacts, ReadsMetadata) {
    const openvdb::FloatGrid::Ptr grid = test::sphereGrid(1, {0, 0, 0}, 0.1F);
    EXPECT_EQ(unitOf(*grid), "world units");
    EXPECT_EQ(upOf(*grid), "z");
    EXPECT_FALSE(partOf(*grid));
    EXPECT_TRUE(thinBandWarning("a.vdb", *grid).empty());
    EXPECT_FALSE(thinBandWarning("a.vdb", *test::sphereGrid(1, {0, 0, 0}, 0.1F, 2)).empty());
    grid->insertMeta("up", openvdb::StringMetadata("y"));
    grid->insertMeta("part_bbox_min", openvdb::Vec3DMetadata(openvdb::Vec3d(0, 0, 0)));
    grid->insertMeta("part_bbox_max", openvdb::Vec3DMetadata(openvdb::Vec3d(1, 2, 3)));
    EXPECT_EQ(upOf(*grid), "y");
    ASSERT_TRUE(partOf(*grid));
    EXPECT_EQ(partOf(*grid)->max, glm::dvec3(1, 2, 3));
    grid->insertMeta("part_bbox_max", openvdb::Vec3DMetadata(openvdb::Vec3d(-1, 2, 3)));
    EXPECT_FALSE(partOf(*grid));
    EXPECT_TRUE(outlineOf(*grid).empty());
    grid->insertMeta("part_outline", openvdb::StringMetadata("0 0 0 1 2 0.1"));
    ASSERT_EQ(outlineOf(*grid).size(), 2U);
    EXPECT_EQ(outlineOf(*grid)[1], glm::dvec3(1, 2, double{0.1F}));
    grid->insertMeta("part_outline", openvdb::StringMetadata("0 0 0 1 2"));
    EXPECT_TRUE(outlineOf(*grid).empty());
}

TEST(FileFacts, IdentifiesAFileByItsBytes) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "a", "one");
    const std::string one = identityOf((scratch / "a").string());
    EXPECT_FALSE(one.empty());
    test::writeText(scratch / "a", "two");
    EXPECT_NE(identityOf((scratch / "a").string()), one);
    EXPECT_TRUE(identityOf((scratch / "missing").string()).empty());
}

}  // namespace
}  // namespace stratum::assemble
