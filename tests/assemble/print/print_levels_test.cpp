#include "assemble/print/print_levels.h"

#include "base/error.h"
#include "prints.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace stratum::assemble {
namespace {

const std::string kTile = (test::sourceDir() / "data/gcode/tile.gcode").string();

PrintLevels read(const PrintRequest& request, const std::string& path = kTile, bool hash = false) {
    const ReadEvents events;
    Warnings warnings(events);
    return readPrintLevels(path, request, hash, events, warnings);
}

PrintRequest coarse() { return test::coarseTracing().prints; }

TEST(PrintLevels, OneLevelOfTheWholePrint) {
    const PrintLevels print = read(coarse(), kTile, true);
    ASSERT_EQ(print.levels.size(), 1U);
    EXPECT_EQ(print.levels[0].from, 0.0);
    EXPECT_EQ(print.moments, (std::vector<std::uint32_t>{static_cast<std::uint32_t>(print.toolpath->beads.size())}));
    EXPECT_EQ(print.content.size(), 64U);
    EXPECT_LT(print.part.min[0], print.part.max[0]);
    EXPECT_EQ(print.report["selected_beads"], print.selection.size());
}

TEST(PrintLevels, ANearEyeSeesFarBeadsCoarser) {
    PrintRequest request = coarse();
    request.print.lattice.voxel_size.reset();
    request.print.voxel_auto = true;
    request.pixel_spread = [](const voxelize::Bounds&, const voxelize::Bounds& part, std::span<const glm::dvec3>) {
        shade::PixelSpread spread;
        spread.eye = {0.5 * (part.min[0] + part.max[0]), 0.5 * (part.min[1] + part.max[1]), part.max[2]};
        spread.smallest = 0.1;
        spread.per_distance = 0.1;
        spread.farthest = 50;
        return spread;
    };
    const PrintLevels print = read(request);
    ASSERT_GT(print.levels.size(), 1U);
    for (std::size_t n = 1; n < print.levels.size(); ++n) EXPECT_GT(print.levels[n].from, print.levels[n - 1].from);
    EXPECT_EQ(print.report["voxel_auto"]["levels"].size(), print.levels.size());
    request.pixel_spread = {};
    EXPECT_THROW((void)read(request), UsageError);
}

TEST(PrintLevels, VoxelsThatNobodyChoseFollowShortPixels) {
    PrintRequest request = coarse();
    request.print.lattice.voxel_size.reset();
    const auto voxelsAt = [&request](std::optional<double> pixel) {
        request.pixel_spread = nullptr;
        if (pixel)
            request.pixel_spread = [pixel](const voxelize::Bounds&, const voxelize::Bounds&,
                                           std::span<const glm::dvec3>) {
                return shade::PixelSpread{.smallest = *pixel};
            };
        const PrintLevels print = read(request);
        EXPECT_EQ(print.levels.size(), 1U);
        const voxelize::Lattice& lattice = print.levels.front().field->layout().lattice;
        return std::lround(lattice.layer_height / lattice.voxel_size);
    };
    EXPECT_EQ(voxelsAt(0.001), 8);
    EXPECT_EQ(voxelsAt(1), 4);
    EXPECT_EQ(voxelsAt(std::nullopt), 4);
    request.print.lattice.voxels_per_layer = 3;
    EXPECT_EQ(voxelsAt(0.001), 3);
}

TEST(PrintLevels, MomentsGrowToTheWholePrint) {
    PrintRequest request = coarse();
    request.series = 4;
    request.outline = true;
    const PrintLevels print = read(request);
    EXPECT_FALSE(print.outline.empty());
    EXPECT_EQ(print.moments.size(), 4U);
    EXPECT_TRUE(std::is_sorted(print.moments.begin(), print.moments.end()));
    EXPECT_EQ(print.moments.back(), print.toolpath->beads.size());
}

TEST(PrintLevels, PartOfAPrint) {
    const PrintLevels whole = read(coarse());
    PrintRequest request = coarse();
    request.printed = "50%";
    request.print.layers = "2:";
    const PrintLevels half = read(request);
    EXPECT_LT(half.selection.size(), whole.selection.size());
    EXPECT_EQ(half.report["printed"], "50%");
    EXPECT_EQ(half.report["selection"], "layers 2:");
}

TEST(PrintLevels, RefusesBadRequests) {
    PrintRequest request = coarse();
    request.printed = "25%,50%";
    EXPECT_THROW((void)read(request), UsageError);
    request = coarse();
    request.print.lattice.half_width = 1;
    EXPECT_THROW((void)read(request), UsageError);
    request = coarse();
    request.print.layers = "900:";
    EXPECT_ANY_THROW((void)read(request));
    const test::ScratchFolder scratch;
    test::writeText(scratch / "a.vdb", "not a grid");
    EXPECT_THROW((void)read(coarse(), (scratch / "a.vdb").string()), InputError);
}

}  // namespace
}  // namespace stratum::assemble
