#include "view/beads/bead_look.h"

#include "given_tile.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace stratum::view {
namespace {

// Each bead has the colour of its feature in the legend.
TEST(BeadLook, ColoursAreThoseOfTheLegend) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    ViewState state;
    state.width = state.height = 64;
    state.color_by = "feature";
    const PicturePlan plan = planPicture(document.given(), state);
    scene.makeObjects(plan, {});
    const ViewedPicture picture = scene.picture(plan, 64, 64);
    const gcode::Toolpath& print = *document.toolpath(0);
    const BeadColors colors = colorsOf(picture, print, "feature");
    ASSERT_EQ(colors.places.size(), print.beads.size());
    std::map<std::string, shade::Color> legend;
    for (const auto& entry : scene.objects().legends.at(0).entries) legend[entry.name] = entry.color;
    for (std::size_t n = 0; n < print.beads.size(); n += 97) {
        const auto found = legend.find(std::string(gcode::featureName(print.runOf(print.beads[n]).feature)));
        if (found == legend.end()) continue;  // before the first layer
        // The reflectance of a plastic is its colour and a little gloss.
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(colors.palette[colors.places[n]][c], found->second[c], 0.03);
    }
}

TEST(BeadLook, OneMaterialNeedsNoColours) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    const PicturePlan plan = planPicture(document.given(), {});
    scene.makeObjects(plan, {});
    const ViewedPicture picture = scene.picture(plan, 64, 64);
    EXPECT_TRUE(colorsOf(picture, *document.toolpath(0), "").places.empty());
    const nlohmann::json look = lookOf(picture, plan, nullptr);
    EXPECT_FALSE(look["bed"].is_null());
    EXPECT_GT(look["reach"], 1.0);
    EXPECT_TRUE(look["follows"]);
}

}  // namespace
}  // namespace stratum::view
