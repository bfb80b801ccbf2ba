#include "gcode/slicer/slicer_tags.h"

#include "gcode/slicer/feature_names.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

using Kind = Tag::Kind;

struct FeatureCase {
    std::string_view comment;
    Feature feature;
};

TEST(SlicerTags, Features) {
    constexpr FeatureCase kCases[] = {
        {"TYPE:External perimeter", Feature::external_perimeter},  // PrusaSlicer
        {"TYPE:Skirt/Brim", Feature::skirt},
        {"TYPE:Top solid infill", Feature::top_infill},
        {"TYPE:Custom", Feature::custom},
        {"TYPE:Internal bridge infill", Feature::bridge},  // SuperSlicer
        {"TYPE:Internal perimeter", Feature::perimeter},
        {"TYPE:WALL-OUTER", Feature::external_perimeter},  // Cura
        {"TYPE:WALL-INNER", Feature::perimeter},
        {"TYPE:SKIN", Feature::solid_infill},
        {"TYPE:FILL", Feature::infill},
        {"TYPE:SUPPORT-INTERFACE", Feature::support_interface},
        {"TYPE:PRIME-TOWER", Feature::wipe_tower},
        {"TYPE:SOLID-FILL", Feature::solid_infill},             // ideaMaker
        {" FEATURE: Outer wall", Feature::external_perimeter},  // BambuStudio
        {" perimeter", Feature::perimeter},                     // Slic3r, behind a move
        {" infill", Feature::infill},
        {" outer perimeter", Feature::external_perimeter},  // Simplify3D
        {" solid layer", Feature::solid_infill},
        {"TYPE:What is this", Feature::unknown},
    };
    for (const FeatureCase& c : kCases) {
        const Tag tag = parseTag(c.comment);
        EXPECT_EQ(tag.kind, Kind::feature) << c.comment;
        EXPECT_EQ(tag.feature, c.feature) << c.comment;
    }
    EXPECT_EQ(parseTag("TYPE:What is this").text, "What is this");
}

TEST(SlicerTags, EveryFeatureButUnknownHasASlicersName) {
    EXPECT_EQ(featureOfType("IRONING"), Feature::ironing);
    EXPECT_EQ(featureOfType("Gap fill"), Feature::gap_fill);
    EXPECT_EQ(featureOfType("Brim"), Feature::brim);
    EXPECT_FALSE(featureOfType("").has_value());
}

TEST(SlicerTags, Heights) {
    EXPECT_EQ(parseTag("HEIGHT:0.199999").height, 0.199999);
    EXPECT_EQ(parseTag(" LAYER_HEIGHT: 0.08").height, 0.08);
    EXPECT_EQ(parseTag(" tool H0.200 W0.450").height, 0.2);
    for (const auto* comment : {"HEIGHT:0.2", " tool H0.2 W0.4"}) EXPECT_EQ(parseTag(comment).kind, Kind::height);
    for (const auto* comment : {"HEIGHT:", "HEIGHT:-1", "HEIGHT:0", "HEIGHT:nan", " tool 1", "WIDTH:0.45"})
        EXPECT_EQ(parseTag(comment).kind, Kind::none) << comment;
}

TEST(SlicerTags, HeightsThatNoLayerHas) {
    const std::string digits(60, '3');
    for (const std::string& number :
         {std::string("101"), digits, digits + digits + digits + digits + digits + digits}) {
        EXPECT_EQ(parseTag("HEIGHT:" + number).kind, Kind::none) << number;
        EXPECT_EQ(parseTag(" tool H" + number).kind, Kind::none) << number;
        EXPECT_EQ(parseTag("; --- layer 0 (" + number + " @ 0.255) ---").height, 0) << number;
    }
}

TEST(SlicerTags, Layers) {
    for (const auto* comment : {"LAYER_CHANGE", "LAYER:0", "LAYER:-3", " CHANGE_LAYER", " layer 12, Z = 2.400",
                                "; --- layer 3 (0.200 @ 0.85) ---"})
        EXPECT_EQ(parseTag(comment).kind, Kind::layer_change) << comment;
    EXPECT_EQ(parseTag("; --- layer 0 (0.250 @ 0.255) ---").height, 0.25);
    EXPECT_EQ(parseTag("; --- layer 17 0.25 @ 4.035 ---").height, 0.25);
    EXPECT_EQ(parseTag("; --- layer 17 ---").kind, Tag::Kind::none);
    for (const auto* comment : {"LAYER_COUNT:25", "BEFORE_LAYER_CHANGE", "AFTER_LAYER_CHANGE", " layer end",
                                " layer_height = 0.2", " layer 3", "Z:0.2", "Layer height: 0.2"})
        EXPECT_EQ(parseTag(comment).kind, Kind::none) << comment;
}

TEST(SlicerTags, Objects) {
    const Tag start = parseTag(" printing object cube_1.stl id:0 copy 1");
    EXPECT_EQ(start.kind, Kind::object_start);
    EXPECT_EQ(start.text, "cube_1.stl id:0 copy 1");
    EXPECT_EQ(parseTag(" stop printing object cube_1.stl id:0 copy 1").kind, Kind::object_stop);
    EXPECT_EQ(parseTag("MESH:hull.stl").text, "hull.stl");
    EXPECT_EQ(parseTag("MESH:NONMESH").kind, Kind::object_stop);
    EXPECT_EQ(parseTag(" INIT printing object cube").kind, Kind::none);
}

TEST(SlicerTags, ProseIsNoTag) {
    for (const auto* comment : {"", " ", " use absolute coordinates", " perimeters = 3", " infill_only = 0",
                                " perimeters extrusion width = 0.45mm", "0.35", " object:{\"name\":\"a\"}"})
        EXPECT_EQ(parseTag(comment).kind, Kind::none) << comment;
}

}  // namespace
}  // namespace stratum::gcode
