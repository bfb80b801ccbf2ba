#include "march/file/vdb_check.h"

#include "base/error.h"
#include "march/file/level_set_file.h"
#include "refusal.h"
#include "rubble.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cstring>
#include <fstream>
#include <string>

namespace stratum::march {
namespace {

namespace fs = std::filesystem;

class VdbCheck : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }
    test::ScratchFolder folder_;

    std::string bytesOf(const openvdb::GridCPtrVec& grids, std::uint32_t compression) const {
        const fs::path path = folder_ / "grids.vdb";
        openvdb::io::File file(path.string());
        file.setCompression(compression);
        file.write(grids);
        file.close();
        return test::bytesOf(path);
    }

    static std::string refusal(const std::string& bytes, VdbDepth depth = VdbDepth::leaves,
                               const std::string& name = "surface") {
        return test::messageOf<InputError>([&] { checkVdb(std::string_view(bytes), depth, name, "a.vdb"); });
    }

    // One leaf.
    static openvdb::FloatGrid::Ptr small() {
        auto grid = openvdb::FloatGrid::create(0.3F);
        grid->setName("surface");
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
        for (int n = 0; n < 100; ++n) grid->tree().setValueOn(openvdb::Coord(n % 8, n / 8 % 8, n / 64), 0.01F * n);
        return grid;
    }
};

constexpr std::uint32_t kZip = openvdb::io::COMPRESS_ZIP, kMaskFlag = openvdb::io::COMPRESS_ACTIVE_MASK,
                        kBloscFlag = openvdb::io::COMPRESS_BLOSC;

TEST_F(VdbCheck, AcceptsWhatOpenVdbWrites) {
    const auto grid = test::rubble(0.05F, true);
    auto layer = openvdb::Int32Grid::create(-1);
    layer->setName("layer");
    auto color = openvdb::Vec3SGrid::create();
    color->setName("color");
    for (auto i = grid->cbeginValueOn(); i; ++i) {
        if (!i.isVoxelValue()) continue;
        layer->tree().setValueOn(i.getCoord(), i.getCoord()[2]);
        color->tree().setValueOn(i.getCoord(), openvdb::Vec3s(i.getValue()));
    }
    const auto half = grid->deepCopy();
    half->setSaveFloatAsHalf(true);
    half->setName("half");
    const auto half_color = color->deepCopy();
    half_color->setSaveFloatAsHalf(true);
    half_color->setName("half_color");
    const auto zipped = grid->deepCopy();
    zipped->setGridClass(openvdb::GRID_UNKNOWN);
    zipped->setName("zipped");
    const auto twin = grid->copy();
    twin->setName("twin");
    const auto points = openvdb::GridBase::createGrid("Tree_bool_5_4_3");
    points->setName("points");
    for (const std::uint32_t compression :
         {kMaskFlag | kBloscFlag, kMaskFlag | kZip, kBloscFlag, kZip, kMaskFlag, std::uint32_t{0}}) {
        const std::string bytes = bytesOf({grid, layer, color, half, half_color, zipped, twin, points}, compression);
        for (const char* name : {"surface", "layer", "color", "half", "half_color", "zipped", "twin"})
            EXPECT_EQ(refusal(bytes, VdbDepth::leaves, name), "") << name << " " << compression;
        EXPECT_EQ(refusal(bytes, VdbDepth::nodes), "");
        // Nobody has checked its tree.
        EXPECT_NE(refusal(bytes, VdbDepth::leaves, "points"), "");
    }
    EXPECT_EQ(refusal(bytesOf({openvdb::FloatGrid::create(1.0F)}, kMaskFlag | kBloscFlag), VdbDepth::leaves, ""), "");
}

// The list of the leaves' sizes is packed differently by its length.
TEST_F(VdbCheck, AcceptsAnyNumberOfLeaves) {
    for (int leaves = 1; leaves <= 140; ++leaves) {
        auto grid = openvdb::FloatGrid::create(0.3F);
        grid->setName("surface");
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
        for (int n = 0; n < leaves; ++n) grid->tree().setValue(openvdb::Coord(8 * n, 0, 0), 0.1F);
        const std::string bytes = bytesOf({grid}, openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
        EXPECT_EQ(refusal(bytes), "") << leaves << " leaves";
    }
}

TEST_F(VdbCheck, RefusesEveryCut) {
    for (const std::uint32_t compression : {kMaskFlag | kBloscFlag, kMaskFlag | kZip, kMaskFlag}) {
        const std::string bytes = bytesOf({small()}, compression);
        for (std::size_t size = 1; size < bytes.size(); size += size < 1000 ? 1 : 37)
            EXPECT_NE(refusal(bytes.substr(0, size)), "") << size;
    }
}

// What OpenVDB would believe: each 32-bit word of the head, at its largest.
TEST_F(VdbCheck, EveryLargeNumberIsRefusedOrHarmless) {
    const std::string bytes = bytesOf({small()}, kMaskFlag | kBloscFlag);
    std::size_t refused = 0;
    const fs::path path = folder_ / "broken.vdb";
    for (std::size_t at = 8; at < 1200; at += 3) {
        std::string broken = bytes;
        std::memset(broken.data() + at, 0x7f, 4);
        std::ofstream(path, std::ios::binary) << broken;
        try {
            (void)readLevelSet(path);
            (void)openLevelSet(path);
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 150U);
}

TEST_F(VdbCheck, RefusesTwoNodesAtOnePlace) {
    auto grid = small();
    grid->tree().setValueOn(openvdb::Coord(4096, 0, 0), 0.1F);
    std::string bytes = bytesOf({grid}, kMaskFlag | kBloscFlag);
    const std::int32_t second[3] = {4096, 0, 0};
    const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(second), sizeof second));
    ASSERT_NE(at, std::string::npos);
    std::memset(bytes.data() + at, 0, sizeof second);
    EXPECT_NE(refusal(bytes).find("out of order"), std::string::npos);
}

// OpenVDB casts the second map of a frustum to an affine one, whatever it is.
TEST_F(VdbCheck, RefusesAFrustumOfAnotherKind) {
    auto grid = small();
    grid->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 10.0));
    std::string bytes = bytesOf({grid}, kMaskFlag | kBloscFlag);
    EXPECT_EQ(refusal(bytes), "");
    const std::size_t at = bytes.find("AffineMap", bytes.find("NonlinearFrustumMap"));
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, 9, "ScaleMap1");
    EXPECT_NE(refusal(bytes).find("frustum"), std::string::npos);
}

TEST_F(VdbCheck, RefusesOtherFormats) {
    std::string bytes = bytesOf({small()}, kMaskFlag | kBloscFlag);
    EXPECT_NE(refusal("not a vdb at all, but long enough to be one"), "");
    bytes[8] = static_cast<char>(221);
    EXPECT_NE(refusal(bytes).find("format 221"), std::string::npos);
    bytes[8] = static_cast<char>(226);
    EXPECT_NE(refusal(bytes).find("format 226"), std::string::npos);
}

// OpenVDB 13 writes format 225, and each grid of floats as before.
TEST_F(VdbCheck, AcceptsTheFormatOfOpenVdb13) {
    const auto grid = test::rubble(0.1F, true);
    std::string bytes = bytesOf({grid}, kMaskFlag | kBloscFlag);
    bytes[8] = static_cast<char>(225);
    EXPECT_EQ(refusal(bytes), "");
    std::ofstream(folder_ / "newer.vdb", std::ios::binary) << bytes;
    testing::internal::CaptureStderr();
    EXPECT_EQ(readLevelSet(folder_ / "newer.vdb")->activeVoxelCount(), grid->activeVoxelCount());
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace stratum::march
