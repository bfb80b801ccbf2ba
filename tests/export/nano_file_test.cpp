#include "export/nano_file.h"

#include "base/error.h"
#include "base/input_file.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <tbb/global_control.h>

#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>

#include <cmath>
#include <string>

namespace stratum::exporter {
namespace {

openvdb::FloatGrid::Ptr ball() {
    openvdb::initialize();
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(7.0F, {1, 2, 3}, 0.25F);
    grid->setName("surface");
    return grid;
}

TEST(NanoFile, HoldsTheValuesOfTheGrid) {
    const test::ScratchFolder folder;
    const openvdb::FloatGrid::Ptr grid = ball();
    const auto values = grid->getConstAccessor();
    for (const Compression compression : {Compression::blosc, Compression::zip, Compression::none})
        for (const bool half : {false, true}) {
            const std::string path = (folder / "a.nvdb").string();
            writeNano({grid}, path, {half, compression});
            const auto handle = nanovdb::io::readGrid(path);
            const nanovdb::GridMetaData* const facts = handle.gridMetaData();
            ASSERT_NE(facts, nullptr);
            EXPECT_STREQ(facts->shortGridName(), "surface");
            EXPECT_EQ(facts->gridType(), half ? nanovdb::GridType::Fp16 : nanovdb::GridType::Float);
            EXPECT_EQ(facts->gridClass(), nanovdb::GridClass::LevelSet);
            EXPECT_EQ(facts->activeVoxelCount(), grid->activeVoxelCount());
            EXPECT_DOUBLE_EQ(facts->voxelSize()[0], 0.25);
            double worst = 0;
            const auto compare = [&](const auto* nano) {
                ASSERT_NE(nano, nullptr);
                auto read = nano->getAccessor();
                for (auto at = grid->cbeginValueOn(); at; ++at) {
                    const openvdb::Coord c = at.getCoord();
                    worst = std::max(worst, std::abs(double(read.getValue({c[0], c[1], c[2]}) - *at)));
                }
                EXPECT_LT(read.getValue({4, 8, 12}), 0.0F);  // inside
                EXPECT_EQ(read.getValue({400, 8, 12}), grid->background());
            };
            if (half)
                compare(handle.grid<nanovdb::Fp16>());
            else
                compare(handle.grid<float>());
            // Two half-widths of three voxels in 16 bits.
            EXPECT_LE(worst, half ? 1.5 / 65535 : 0.0);
        }
}

TEST(NanoFile, GridsOfOtherTypesFollow) {
    const test::ScratchFolder folder;
    const openvdb::FloatGrid::Ptr surface = ball();
    const auto layer = openvdb::Int32Grid::create(-1);
    layer->setName("layer");
    layer->tree().setValue({1, 2, 3}, 42);
    const auto color = openvdb::Vec3SGrid::create();
    color->setName("color");
    color->tree().setValue({1, 2, 3}, {0.5F, 0.25F, 1.0F});
    const std::string path = (folder / "a.NVDB").string();
    ASSERT_TRUE(isNanoPath(path));
    writeNano({surface, layer, color}, path);
    const auto all = nanovdb::io::readGrids(path);
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(all[1].grid<std::int32_t>()->getAccessor().getValue({1, 2, 3}), 42);
    EXPECT_EQ(all[2].grid<nanovdb::Vec3f>()->getAccessor().getValue({1, 2, 3})[1], 0.25F);
}

TEST(NanoFile, SameBytesForAnyNumberOfThreads) {
    const test::ScratchFolder folder;
    const openvdb::FloatGrid::Ptr grid = ball();
    writeNano({grid}, folder / "many.nvdb", {true});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    writeNano({grid}, folder / "one.nvdb", {true});
    EXPECT_EQ(InputFile(folder / "many.nvdb").bytes(), InputFile(folder / "one.nvdb").bytes());
}

TEST(NanoFile, RefusesWhatItCant) {
    const test::ScratchFolder folder;
    EXPECT_THROW(writeNano({ball()}, folder / "none/a.nvdb"), OutputError);
    EXPECT_THROW(writeNano({openvdb::GridBase::createGrid("Tree_double_5_4_3")}, folder / "a.nvdb"),
                 std::invalid_argument);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.nvdb"));
    EXPECT_FALSE(isNanoPath("a.vdb"));
}

}  // namespace
}  // namespace stratum::exporter
