#include "voxelize/beads/selection.h"

#include "base/error.h"
#include "refusal.h"
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
    Selection all;
    parseFeatures("all", all);
    EXPECT_EQ(all.features, Selection().features);
    EXPECT_EQ(countKept(all_but), 10U);
    Selection selection;
    for (const char* bad : {"", "infill", "+", "+nothing", "infill,+skirt"})
        EXPECT_THROW(parseFeatures(bad, selection), UsageError) << bad;
}

// As tenLayers(), the odd layers of "boat", the even ones of "7"; infill belongs to no object.
gcode::Toolpath twoObjects() {
    gcode::Toolpath toolpath = tenLayers();
    toolpath.objects = {"", "boat", "7"};
    for (gcode::Run& run : toolpath.runs)
        if (run.feature == gcode::Feature::perimeter) run.object = run.layer % 2 == 1 ? 1 : 2;
    return toolpath;
}

TEST(Selection, ObjectsByNameAndNumber) {
    const gcode::Toolpath toolpath = twoObjects();
    const auto kept = [&](std::initializer_list<std::string_view> names) {
        Selection selection;
        selection.last_layer = 3;
        for (const std::string_view name : names) chooseObject(name, toolpath, selection);
        return selectBeads(toolpath, selection);
    };
    using Beads = std::vector<std::uint32_t>;
    EXPECT_EQ(kept({"boat"}), (Beads{0, 4}));
    EXPECT_EQ(kept({"1"}), (Beads{0, 4}));
    EXPECT_EQ(kept({"7"}), (Beads{2}));  // the name, though there is no object of that number
    EXPECT_EQ(kept({"2"}), (Beads{2}));
    EXPECT_EQ(kept({"2", "boat"}), (Beads{0, 2, 4}));
    EXPECT_EQ(kept({"0"}), (Beads{1, 3, 5}));
}

TEST(Selection, Tools) {
    gcode::Toolpath toolpath = tenLayers();
    for (std::size_t n = 0; n < 6; ++n) toolpath.runs[n].tool = 1;
    Selection selection;
    selection.tools = {1};
    EXPECT_EQ(selectBeads(toolpath, selection).size(), 6U);
    selection.tools = {0, 1};
    EXPECT_EQ(selectBeads(toolpath, selection).size(), 20U);
    selection.tools = {7};
    EXPECT_THROW((void)selectBeads(toolpath, selection), InputError);
}

TEST(Selection, AnUnknownToolIsToldWhichThereAre) {
    gcode::Toolpath toolpath = tenLayers();
    for (std::size_t n = 0; n < 6; ++n) toolpath.runs[n].tool = 3;
    Selection selection;
    chooseTool(3, toolpath, selection);
    EXPECT_EQ(selectBeads(toolpath, selection).size(), 6U);
    EXPECT_TRUE(test::refuses<UsageError>("--tool 1: the print has no such tool; its tools are 0, 3",
                                          [&] { chooseTool(1, toolpath, selection); }));
    EXPECT_TRUE(test::refuses<UsageError>("all of it is by tool 0", [&] { chooseTool(1, tenLayers(), selection); }));
}

TEST(Selection, AnUnknownObjectGetsTheList) {
    Selection selection;
    for (const char* bad : {"ship", "3", "-1", "", "boat "}) {
        EXPECT_TRUE(test::refuses<UsageError>("\n  1: boat\n  2: 7", [&] {
            chooseObject(bad, twoObjects(), selection);
        })) << bad;
    }
    EXPECT_TRUE(test::refuses<UsageError>("names no objects", [&] { chooseObject("1", tenLayers(), selection); }));
}

TEST(Selection, AnObjectWithoutBeadsLeavesNone) {
    gcode::Toolpath toolpath = twoObjects();
    toolpath.objects.emplace_back("defined but never printed");
    Selection selection;
    chooseObject("3", toolpath, selection);
    EXPECT_THROW(selectBeads(toolpath, selection), InputError);
}

TEST(Snapshots, PercentLayerAndEvery) {
    const gcode::Toolpath toolpath = tenLayers();
    const auto snapshots = parseSnapshots("50%,layer:3,every:4,25%", toolpath);
    ASSERT_EQ(snapshots.size(), 5U);
    EXPECT_EQ(snapshots[0].label, "025pct");
    EXPECT_EQ(snapshots[0].bead_count, 5U);
    EXPECT_EQ(snapshots[1].label, "layer0003");
    EXPECT_EQ(snapshots[1].bead_count, 6U);
    EXPECT_EQ(snapshots[2].label, "layer0004");
    EXPECT_EQ(snapshots[3].label, "050pct");
    EXPECT_EQ(snapshots[3].bead_count, 10U);
    EXPECT_EQ(snapshots[4].label, "layer0008");
    for (const char* bad : {"", "0%", "101%", "x%", "layer:", "layer:11", "every:0", "half"})
        EXPECT_THROW(parseSnapshots(bad, toolpath), UsageError) << bad;
}

TEST(Snapshots, OneMomentOfOneNameIsThereOnce) {
    const gcode::Toolpath toolpath = tenLayers();
    for (const char* text : {"100%,layer:10,100%", "50%,50.0%,layer:5,50%"})
        EXPECT_EQ(parseSnapshots(text, toolpath).size(), 2U) << text;
}

// Half of the print is half of what is drawn.
TEST(Snapshots, PrimeLinesAreNoShare) {
    gcode::Toolpath toolpath = tenLayers();
    const gcode::Toolpath without = toolpath;
    // Before the first layer, as much as all layers.
    gcode::Run prime = toolpath.runs.front();
    prime.layer = 0;
    toolpath.runs.push_back(prime);
    std::vector<gcode::Bead> beads = without.beads;
    for (gcode::Bead& bead : beads) bead.run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
    toolpath.beads.insert(toolpath.beads.begin(), beads.begin(), beads.end());
    for (const char* text : {"25%", "50%", "100%"})
        EXPECT_EQ(parseSnapshots(text, toolpath)[0].bead_count,
                  beads.size() + parseSnapshots(text, without)[0].bead_count)
            << text;
}

TEST(Snapshots, LabelsOfOneKindSortAsTheyPrint) {
    const gcode::Toolpath toolpath = tenLayers();
    const auto snapshots = parseSnapshots("12.5%,100%,50%", toolpath);
    ASSERT_EQ(snapshots.size(), 3U);
    EXPECT_EQ(snapshots[0].label, "012.5pct");
    EXPECT_EQ(snapshots[1].label, "050.0pct");
    EXPECT_EQ(snapshots[2].label, "100.0pct");
}

TEST(Selection, GuessesMistypedFeatures) {
    Selection selection;
    EXPECT_TRUE(test::refuses<UsageError>("did you mean 'skirt'?", [&] { parseFeatures("-skirl", selection); }));
}

// Beads of half a minute each, and half a minute of travel before every layer: 15 minutes.
gcode::Toolpath timedLayers() {
    gcode::Toolpath toolpath = tenLayers();
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i)
        toolpath.timing.push_back({.start = 30.0 * static_cast<double>(i + 1 + i / 2), .seconds = 30});
    return toolpath;
}

TEST(Snapshots, TimesAreThePlans) {
    const gcode::Toolpath toolpath = timedLayers();
    const auto beads = [&](std::string_view text) {
        const auto snapshots = parseSnapshots(text, toolpath);
        return snapshots.size() == 1 ? snapshots[0].bead_count : 999;
    };
    EXPECT_EQ(beads("time:1"), 1U);    // travel and a bead
    EXPECT_EQ(beads("time:1.5"), 2U);  // the second
    EXPECT_EQ(beads("time:2"), 2U);    // travel alone
    EXPECT_EQ(beads("time:90s"), 2U);
    EXPECT_EQ(beads("time:3m"), 4U);
    EXPECT_EQ(beads("time:0.1h"), 8U);
    EXPECT_EQ(beads("time:50%"), 10U);
    EXPECT_EQ(beads("time:100%"), 20U);
    EXPECT_EQ(parseSnapshots("time:90s", toolpath)[0].label, "000090s");
    EXPECT_EQ(parseSnapshots("time:3", toolpath)[0].label, "0003min");
    EXPECT_EQ(parseSnapshots("time:50%", toolpath)[0].label, "time050pct");
    for (const char* text : {"time:", "time:0", "time:-1", "time:101%", "time:x", "time:3d", "time:nan", "time:inf"})
        EXPECT_THROW(parseSnapshots(text, toolpath), UsageError) << text;
    EXPECT_TRUE(needsTiming("25%,time:3"));
    EXPECT_FALSE(needsTiming("25%,layer:3"));
}

TEST(Snapshots, ANumberOfBeads) {
    const gcode::Toolpath toolpath = tenLayers();
    EXPECT_EQ(parseSnapshots("bead:2", toolpath).front().bead_count, 2U);
    EXPECT_EQ(parseSnapshots("bead:2", toolpath).front().label, "bead000000002");
    for (const char* text : {"bead:0", "bead:21", "bead:", "bead:1.5", "bead:-1"})
        EXPECT_THROW((void)parseSnapshots(text, toolpath), UsageError) << text;
}

}  // namespace
}  // namespace stratum::voxelize
