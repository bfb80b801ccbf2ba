#include "view/inspect.h"

#include "belt_box.h"
#include "given_tile.h"
#include "scratch_folder.h"
#include "view/input/program_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

namespace stratum::view {
namespace {

TEST(Inspect, ABeadAndItsLine) {
    Document document(test::givenTile(0.1));
    ViewScene scene(document);
    ViewState state;
    state.width = state.height = 100;
    state.named = shade::View::top;
    state.last_layer = 2;  // solid
    const PicturePlan plan = planPicture(document.given(), state);
    scene.makeObjects(plan, {});
    const ViewedPicture picture = scene.picture(plan, 100, 100);
    int hits = 0;
    for (int n = 0; n < 9; ++n) {
        const auto found = inspect(document, scene, picture, {38.3 + 8 * (n % 3), 38.7 + 8 * (n / 3)});
        ASSERT_TRUE(found["hit"]);
        ASSERT_TRUE(found.contains("bead"));
        const auto& bead = found["bead"];
        EXPECT_EQ(bead["layer"], 2);
        EXPECT_NEAR(found["position"][2], 0.4, 0.11);
        EXPECT_GT(bead["time_s"], 0.0);
        // Its own line is among those shown, and moves to its end.
        for (const auto& line : found["lines"]) {
            if (line["number"] != bead["line"]) continue;
            ++hits;
            const std::string text = line["text"];
            EXPECT_NEAR(std::stod(text.substr(text.find('X') + 1)), bead["to"][0], 1e-6) << text;
        }
    }
    EXPECT_EQ(hits, 9);
}

// On a belt a picture shows the print as it lies in the world, and a click finds the line there.
TEST(Inspect, ABeadOnABelt) {
    const test::ScratchFolder scratch;
    const test::BeltBox belt;
    GivenInput given = test::givenTile(0.125);
    given.path = given.objects.front().vdb = (scratch / "belt.gcode").string();
    given.options.tracing.prints.print.read.belt_angle = belt.degrees;
    std::ofstream(given.path) << belt.program();
    Document document(given);
    ViewScene scene(document);
    ViewState state;
    state.named = shade::View::top;
    const PicturePlan plan = planPicture(document.given(), state);
    scene.makeObjects(plan, {});
    EXPECT_NEAR(document.facts()["print"]["height_mm"], belt.layers().back().back().z, 0.3);
    const ViewedPicture picture = scene.picture(plan, 100, 100);
    const auto found = inspect(document, scene, picture, {50.3, 50.7});
    ASSERT_TRUE(found["hit"]);
    ASSERT_TRUE(found.contains("bead"));
    const auto& from = found["bead"]["from"];
    EXPECT_NEAR(from[0], belt.x0, 1e-6);
    for (const int axis : {1, 2}) EXPECT_NEAR(from[axis], found["position"][axis], belt.width);
    // What stands in for fewer layers is cut across them.
    state.last_layer = 10;
    const PicturePlan fewer = planPicture(document.given(), state);
    ASSERT_TRUE(scene.canStandIn(fewer));
    const ViewedPicture cut = scene.standIn(fewer, state, 100, 100);
    const auto tracer = cut.print->makeTracer();
    trace::Hit hit;
    hit.t = trace::kInfinity;
    // The layers begin at the end of the print that has the larger y.
    EXPECT_TRUE(tracer->intersect({{8.0, belt.y1 - 0.5, 50.0}, {0.0, 0.0, -1.0}, 0.0, trace::kInfinity}, hit));
    EXPECT_FALSE(tracer->intersect({{8.0, belt.y0 + 0.5, 50.0}, {0.0, 0.0, -1.0}, 0.0, trace::kInfinity}, hit));
}

TEST(Inspect, NothingBesideThePrint) {
    Document document(test::givenTile(0.1));
    ViewScene scene(document);
    ViewState state;
    state.named = shade::View::iso;
    const PicturePlan plan = planPicture(document.given(), state);
    scene.makeObjects(plan, {});
    EXPECT_FALSE(inspect(document, scene, scene.picture(plan, 100, 100), {1, 1})["hit"]);
    EXPECT_FALSE(inspect(document, scene, scene.picture(plan, 100, 100), {1, 99})["hit"]);  // the bed
}

TEST(ProgramLines, AtTheEndsOfTheFile) {
    const std::string path = test::givenTile(0.1).path;
    KeptProgram program;
    const auto first = program.around(path, {}, 1, 2);
    ASSERT_EQ(first.size(), 3U);
    EXPECT_EQ(first.front().number, 1U);
    const auto beyond = program.around(path, {}, 4000000, 2);
    EXPECT_TRUE(beyond.empty());
}

void writeLines(const std::string& path, int count, const char* word) {
    std::ofstream file(path);
    for (int n = 1; n <= count; ++n) file << "; " << word << ' ' << n << '\n';
}

TEST(ProgramLines, FarIntoTheFile) {
    const std::string path = ::testing::TempDir() + "program_lines_far.gcode";
    constexpr int kLines = 5000;
    writeLines(path, kLines, "line");
    KeptProgram program;
    for (const std::uint32_t number : {1U, 3U, 1023U, 1024U, 1025U, 1026U, 2048U, 2049U, 4999U, 5000U}) {
        const auto lines = program.around(path, {}, number, 2);
        ASSERT_FALSE(lines.empty());
        EXPECT_EQ(lines.front().number, number > 2 ? number - 2 : 1);
        EXPECT_EQ(lines.back().number, std::min<std::uint32_t>(number + 2, kLines));
        for (const ProgramLine& line : lines) EXPECT_EQ(line.text, "; line " + std::to_string(line.number));
    }
}

// A text is found in small and large letters, each line once, from the line on in both directions, and round the ends.
TEST(ProgramLines, ATextIsFound) {
    const std::string path = ::testing::TempDir() + "program_lines_find.gcode";
    std::ofstream(path) << "G1 X1\nM106 S9 ; m106\nG1\nm106\nG1 X2\nM106";
    KeptProgram program;
    const auto found = [&](std::string_view text, std::uint32_t line, bool back) {
        const auto one = program.find(path, {}, text, line, back);
        return std::array<std::size_t, 3>{one.line, one.place, one.count};
    };
    EXPECT_EQ(found("m106", 0, false), (std::array<std::size_t, 3>{2, 1, 3}));
    EXPECT_EQ(found("M106", 2, false), (std::array<std::size_t, 3>{4, 2, 3}));
    EXPECT_EQ(found("M106", 5, false), (std::array<std::size_t, 3>{6, 3, 3}));
    EXPECT_EQ(found("M106", 6, false), (std::array<std::size_t, 3>{2, 1, 3}));
    EXPECT_EQ(found("M106", 6, true), (std::array<std::size_t, 3>{4, 2, 3}));
    EXPECT_EQ(found("M106", 2, true), (std::array<std::size_t, 3>{6, 3, 3}));
    EXPECT_EQ(found("g1 x2", 3, true), (std::array<std::size_t, 3>{5, 1, 1}));
    EXPECT_EQ(found("M107", 3, true), (std::array<std::size_t, 3>{0, 0, 0}));
}

// The file is read once, and again when it is forgotten; one that is larger than the bound each time.
TEST(ProgramLines, AreReadOnce) {
    const std::string path = ::testing::TempDir() + "program_lines_once.gcode";
    writeLines(path, 100, "old");
    KeptProgram kept;
    KeptProgram small(100);
    EXPECT_EQ(kept.around(path, {}, 50, 0).front().text, "; old 50");
    EXPECT_EQ(small.around(path, {}, 50, 0).front().text, "; old 50");
    writeLines(path, 100, "new");
    EXPECT_EQ(kept.around(path, {}, 51, 0).front().text, "; old 51");
    EXPECT_EQ(small.around(path, {}, 51, 0).front().text, "; new 51");
    kept.forget();
    EXPECT_EQ(kept.around(path, {}, 51, 0).front().text, "; new 51");
}

}  // namespace
}  // namespace stratum::view
