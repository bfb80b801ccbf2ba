#include "gcode/slicer/cura.h"

#include "gcode/program.h"
#include "gcode/slicer/settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

// zlib and base64 of "layer_height=0.1\bfilament_diameter=2.85\bfilament_diameter2=0\bnozzle_size=0.4\f" and, as the
// text of a start program, "start.gcode=;filament_diameter=9"; of two diameters, 1.75 and 2.85.
const std::string kOneFilament =
    ";CURA_PROFILE_STRING:eNrLSaxMLYrPSM1MzyixNdAz5EjLzEnMTc0riU/JBNIlqUW2RnoWppjCRrYGHHn5VVU5qfHFmVWpQL0mPMUliUUleunJ"
    "+SmpttaYBlkCAGpwJ1Q=\n";
const std::string kTwoFilaments = ";CURA_PROFILE_STRING:eNpLy8xJzE3NK4lPyQTSJalFtoZ65qYcaejCRrZGehamAJIxEEE=\n";

// A profile in the way of Cura's JSON, broken into lines amid words and blanks.
std::string settingLines(const std::string& json, std::size_t width) {
    std::string text;
    for (std::size_t at = 0; at < json.size(); at += width) text += ";SETTING_3 " + json.substr(at, width) + "\n";
    return text;
}

const std::string kJson =
    R"({"global_quality": "[general]\\nversion = 4\\ndefinition = creality_ender3\\n\\n[values]\\nlayer_height = 0.12\\n)"
    R"(machine_max_acceleration_x = 50\\n\\n", "extruder_quality": ["[metadata]\\nposition = 1\\n\\n[values]\\n)"
    R"(material_diameter = 2.85\\n\\n", "[metadata]\\nposition = 0\\n\\n[values]\\nmaterial_diameter = 1.75\\n\\n"]})";

TEST(CuraProfile, TheLinesOfItsJsonArePutTogether) {
    for (const std::size_t width : {7U, 68U, 1000U}) {
        CuraProfile profile;
        std::string text = settingLines(kJson, width);
        for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
            EXPECT_TRUE(profile.comment(std::string_view(text).substr(at + 1, text.find('\n', at) - at - 1)));
        const std::vector<CuraSetting> settings = profile.settings();
        const auto has = [&](std::optional<std::size_t> extruder, std::string_view key, std::string_view value) {
            return std::any_of(settings.begin(), settings.end(), [&](const CuraSetting& one) {
                return one.extruder == extruder && one.key == key && one.value == value;
            });
        };
        EXPECT_TRUE(has(std::nullopt, "definition", "creality_ender3")) << width;
        EXPECT_TRUE(has(std::nullopt, "machine_max_acceleration_x", "50")) << width;
        EXPECT_TRUE(has(1, "material_diameter", "2.85")) << width;
        EXPECT_TRUE(has(0, "material_diameter", "1.75")) << width;
    }
}

TEST(CuraProfile, DiametersByExtruder) {
    const Settings settings = readSettings(";Generated with Cura_SteamEngine 4.10.0\n" + settingLines(kJson, 68));
    EXPECT_EQ(settings.filament_diameters, (std::vector<double>{1.75, 2.85}));
    EXPECT_EQ(settings.layer_height, 0.12);
    ASSERT_TRUE(settings.slicer_limits.limits);
    EXPECT_EQ(settings.slicer_limits.limits->acceleration, (std::array<double, 4>{50, 500, 100, 5000}));
}

TEST(CuraProfile, Cura15) {
    const Settings settings = readSettings("G1 X1\n" + kOneFilament);
    EXPECT_EQ(settings.filament_diameters, (std::vector<double>{2.85}));  // 0 is the first one's, and \f ends them
    EXPECT_EQ(settings.layer_height, 0.1);
    EXPECT_EQ(settings.slicer, "Cura 15 or before");
    EXPECT_EQ(readSettings("G1 X1\n" + kTwoFilaments).filament_diameters, (std::vector<double>{1.75, 2.85}));
}

TEST(CuraProfile, DamageIsSaid) {
    for (const std::string damaged : {"not base64!", "AAAA", "", "eNrLSaxMLYrPSM1M"}) {
        const Toolpath toolpath = readProgram("M82\nG1 Z.2\nG1 X10 E1\n;CURA_PROFILE_STRING:" + damaged + "\n");
        EXPECT_EQ(warningCount(toolpath, "CURA_PROFILE_STRING is damaged"), 1U) << damaged;
        EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 1.75);
    }
    for (const std::string json : {R"({"global_quality": "a = )", R"(")", R"({"x": "\\)", "}"})
        EXPECT_TRUE(readSettings(settingLines(json, 5)).filament_diameters.empty());
}

}  // namespace
}  // namespace stratum::gcode
