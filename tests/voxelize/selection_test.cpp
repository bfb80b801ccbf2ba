#include "voxelize/selection.h"

#include "io/error.h"
#include "toolpaths.h"

#include <gtest/gtest.h>

namespace stratum::voxelize {
namespace {

// Layers 1 to 10, one perimeter and one infill bead each, of equal volume.
gcode::Toolpath tenLayers() {
    gcode::Toolpath toolpath;
    for (std::uint32_t layer = 1; layer <= 10; ++layer)
        for (const gcode::Feature feature : {gcode::Feature::perimeter, gcode::Feature::infill}) {
            gcode::Run run;
            run.height = 0.2f;
            run.layer = layer;
            run.feature = feature;
            toolpath.runs.push_back(run);
            gcode::Bead bead;
            bead.x1 = 10;
            bead.z0 = bead.z1 = 0.2 * layer;
            bead.width = 0.5f;
            bead.run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
            toolpath.beads.push_back(bead);
        }
    toolpath.layer_count = 10;
    return toolpath;
}

std::size_t countKept(const Selection& selection) { return selectBeads(tenLayers(), selection).size(); }

TEST(Selection, KeepsEverythingByDefault) { EXPECT_EQ(countKept({}), 20U); }

TEST(Selection, LayersAreInclusiveAndOpenEnded) {
    const auto kept = [](std::string_view text) {
        Selection selection;
        parseLayers(text, selection);
        return countKept(selection);
    };
    EXPECT_EQ(kept("2:4"), 6U);
    EXPECT_EQ(kept(":4"), 8U);
    EXPECT_EQ(kept("9:"), 4U);
    EXPECT_EQ(kept("3"), 2U);
    Selection selection;
    for (const char* bad : {"", "a:b", "4:2", "1:2:3", "-1:4", "1.5:2"})
        EXPECT_THROW(parseLayers(bad, selection), UsageError) << bad;
    parseLayers("11:", selection);
    EXPECT_THROW(countKept(selection), InputError);
}

TEST(Selection, FeaturesKeepOrDrop) {
    Selection only;
    parseFeatures("+infill", only);
    EXPECT_EQ(countKept(only), 10U);
    Selection all_but;
    parseFeatures("-infill,-skirt", all_but);
    EXPECT_EQ(countKept(all_but), 10U);
    Selection selection;
    for (const char* bad : {"", "infill", "+", "+nothing", "infill,+skirt"})
        EXPECT_THROW(parseFeatures(bad, selection), UsageError) << bad;
}

TEST(Snapshots, PercentLayerAndEvery) {
    const gcode::Toolpath toolpath = tenLayers();
    const auto snapshots = parseSnapshots("50%,layer:3,every:4,25%", toolpath);
    ASSERT_EQ(snapshots.size(), 5U);
    EXPECT_EQ(snapshots[0].label, "25pct");
    EXPECT_EQ(snapshots[0].bead_count, 5U);
    EXPECT_EQ(snapshots[1].label, "layer0003");
    EXPECT_EQ(snapshots[1].bead_count, 6U);
    EXPECT_EQ(snapshots[2].label, "layer0004");
    EXPECT_EQ(snapshots[3].label, "50pct");
    EXPECT_EQ(snapshots[3].bead_count, 10U);
    EXPECT_EQ(snapshots[4].label, "layer0008");
    for (const char* bad : {"", "0%", "101%", "x%", "layer:", "layer:11", "every:0", "half"})
        EXPECT_THROW(parseSnapshots(bad, toolpath), UsageError) << bad;
}

}  // namespace
}  // namespace stratum::voxelize
