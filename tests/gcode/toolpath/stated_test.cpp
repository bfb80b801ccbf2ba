#include "gcode/toolpath/stated.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/program.h"
#include "gcode/slicer/settings.h"
#include "gcode/summary.h"

#include <gtest/gtest.h>

#include <array>

#include <string>

namespace stratum::gcode {
namespace {

TEST(Stated, Durations) {
    EXPECT_EQ(parseDuration("1d 2h 3m 4s"), 93784);
    EXPECT_EQ(parseDuration("1h 14m 1s"), 4441);
    EXPECT_EQ(parseDuration("1h:20m:36s"), 4836);
    EXPECT_EQ(parseDuration("0 hours 43 minutes"), 2580);
    EXPECT_DOUBLE_EQ(parseDuration("  332.83 minutes").value_or(0), 19969.8);
    EXPECT_EQ(parseDuration("806s"), 806);
    EXPECT_EQ(parseDuration("451"), 451);
    EXPECT_EQ(parseDuration("2.5"), 2.5);
    for (const auto* text : {"", "soon", "-3", "13-07-10 UTC", "1e99999", "3 parsecs"})
        EXPECT_FALSE(parseDuration(text).has_value()) << text;
    // Beyond what any print takes, also before prose.
    for (const auto* text : {"99999999999999999999h", "1e300d 5 of", "99999999999999999999s -"})
        EXPECT_FALSE(parseDuration(text).has_value()) << text;
    EXPECT_EQ(describeDuration(4441), "1 h 14 min 1 s");
    EXPECT_EQ(describeDuration(180.4), "3 min 0 s");
    EXPECT_EQ(describeDuration(7), "7 s");
}

StatedFacts factsOf(std::initializer_list<std::string_view> comments) {
    StatedReader reader;
    for (const std::string_view comment : comments) reader.comment(comment);
    return reader.finish();
}

TEST(Stated, OfSeveralSlicers) {
    EXPECT_EQ(factsOf({"estimated printing time = 1h 5m 24s"}).seconds, 3924);  // Slic3r PE
    EXPECT_EQ(factsOf({"estimated printing time (silent mode) = 9h"}).seconds, std::nullopt);
    EXPECT_EQ(factsOf({"Estimated Build Time:   2.5 minutes"}).seconds, 150);  // KISSlicer
    EXPECT_EQ(factsOf({"Print Time: 744"}).seconds, 744);                      // ideaMaker
    EXPECT_EQ(factsOf({"--- print time: 806s ---"}).seconds, 806);             // Kiri:Moto
    EXPECT_EQ(factsOf({"estimated_time(s): 12"}).seconds, 12);                 // Snapmaker Luban
    EXPECT_EQ(factsOf({"filament used [g] = 3.70, 1.65"}).grams, 5.35);
    EXPECT_EQ(factsOf({"total filament used [g] = 9", "filament used [g] = 3.70, 1.65"}).grams, 9);
    EXPECT_EQ(factsOf({"Plastic weight: 8.14 g (0.02 lb)"}).grams, 8.14);
    EXPECT_EQ(factsOf({"filament cost = 0.25, 0.5"}).cost, 0.75);
    EXPECT_EQ(factsOf({"total filament cost = 0.30", "filament cost = 0.25, 0.5"}).cost, 0.3);
    EXPECT_EQ(factsOf({"total filament cost = 0.00"}).cost, std::nullopt);
    EXPECT_EQ(factsOf({"Material cost: 0.38"}).cost, 0.38);
    EXPECT_EQ(factsOf({"Extruder 1 Material:PETG"}).materials, (std::vector<std::string>{"", "PETG"}));
    EXPECT_EQ(factsOf({"printer_settings_id = mine"}).printer, "mine");
    EXPECT_EQ(factsOf({"printer_settings_id = mine", "printer_model = MK4"}).printer, "MK4");
}

// CuraEngine alone, without Cura, writes 6666 in place of the time.
TEST(Stated, ThePlaceholderOfCuraEngineIsNoTime) {
    EXPECT_EQ(factsOf({"TIME:6666", "TIME_ELAPSED:12.5", "TIME_ELAPSED:1878.75"}).seconds, 1878.75);
    EXPECT_EQ(factsOf({"TIME:6666"}).seconds, std::nullopt);
    EXPECT_EQ(factsOf({"TIME:6665", "TIME_ELAPSED:12.5"}).seconds, 6665);
}

TEST(Stated, AFirstLayerInPerCent) {
    EXPECT_EQ(factsOf({"first_layer_height = 150%", "layer_height = 0.2"}).first_layer_height, 1.5 * 0.2);
    EXPECT_EQ(factsOf({"firstLayerHeightPercentage,50", "layerHeight,0.2"}).first_layer_height, 0.1);
    EXPECT_EQ(factsOf({"first_layer_height = 150%"}).first_layer_height, std::nullopt);
}

TEST(Stated, NonsenseIsAbsent) {
    // 0 g is what slicers write where they know no density.
    EXPECT_TRUE(
        factsOf({"total filament used [g] = 0.00", "TIME:soon", "nozzle_diameter = -1", "layer_height = 0",
                 "printer_model = ", "filament_type = ;", "Time: 13-07-10 UTC", "TIME_ELAPSED:3", "a, b", ":", ","})
            .empty());
}

TEST(Stated, DensitiesAndPrices) {
    const StatedFacts facts = factsOf({"filament_density = 1.24,0,x", "filament_cost = 27.82;0"});
    EXPECT_EQ(facts.densities, (std::vector<double>{1.24, 0, 0}));
    EXPECT_EQ(facts.prices, (std::vector<double>{27.82, 0}));
    // Simplify3D.
    const StatedFacts other = factsOf({"filamentDensities,1.25|1.3", "filamentPricesPerKg,46|-1"});
    EXPECT_EQ(other.densities, (std::vector<double>{1.25, 1.3}));
    EXPECT_EQ(other.prices, (std::vector<double>{46, 0}));
}

TEST(Stated, NamesOfFilamentProfiles) {
    EXPECT_EQ(factsOf({"filament_settings_id = \"Prusament PLA Galaxy Black @MK4\";\"Generic PLA, Silk\""}).profiles,
              (std::vector<std::string>{"Prusament PLA Galaxy Black @MK4", "Generic PLA, Silk"}));
    EXPECT_EQ(factsOf({"filament_settings_id = MyFilament"}).profiles, std::vector<std::string>{"MyFilament"});
}

TEST(Stated, TheBed) {
    using Corners = std::vector<std::array<double, 2>>;
    const auto bedOf = [](const std::string& comments) { return readSettings(comments).stated.bed; };
    EXPECT_EQ(bedOf("; bed_shape = 0x0,250x0,250x210,0x210\n"), (Corners{{0, 0}, {250, 0}, {250, 210}, {0, 210}}));
    EXPECT_EQ(bedOf("; printable_area = -110x-110,110x-110,110x110,-110x110\n")[0], (std::array{-110.0, -110.0}));
    EXPECT_EQ(bedOf("; bed_size_x_mm = 200\n; bed_size_y_mm = 150\n"),
              (Corners{{0, 0}, {200, 0}, {200, 150}, {0, 150}}));
    EXPECT_EQ(bedOf(";   strokeXoverride,145\n;   strokeYoverride,120\n")[2], (std::array{145.0, 120.0}));
    EXPECT_EQ(bedOf(";SETTING_3 {\"global_quality\": \"[values]\\nmachine_width = 220\\nmachine_depth = 200\\n"
                    "machine_center_is_zero = True\\n\"}\n"),
              (Corners{{-110, -100}, {110, -100}, {110, 100}, {-110, 100}}));
    for (const char* nonsense :
         {"; bed_shape = \n", "; bed_shape = 0x0,250x0\n", "; bed_shape = 0x0,1e9x0,nanx1\n",
          "; bed_shape = 0x0,250,250x210\n", "; bed_size_x_mm = 200\n", "; printable_area = 0x0,99999999x0,5x5\n"})
        EXPECT_TRUE(bedOf(nonsense).empty()) << nonsense;
}

TEST(Stated, AreasThatStayFree) {
    using Areas = std::vector<std::vector<std::array<double, 2>>>;
    const auto areasOf = [](const std::string& comments) { return readSettings(comments).stated.excluded; };
    EXPECT_EQ(areasOf("; bed_exclude_area = 0x0,18x0,18x28,0x28\n"), (Areas{{{0, 0}, {18, 0}, {18, 28}, {0, 28}}}));
    EXPECT_EQ(areasOf("; bed_exclude_area = 0x0,5x0,5x5,0x5,9x0,19x0,19x5,9x5\n").at(1),
              (std::vector<std::array<double, 2>>{{9, 0}, {19, 0}, {19, 5}, {9, 5}}));
    EXPECT_EQ(areasOf("; bed_exclude_area = 0x0,5x0,2x5\n").at(0).size(), 3U);
    for (const char* none :
         {"; bed_exclude_area = \n", "; bed_exclude_area = 0x0\n", "; bed_exclude_area = 0x0,1e9x0,1x1\n"})
        EXPECT_TRUE(areasOf(none).empty()) << none;
}

TEST(Stated, TheSummaryBeginsWithIt) {
    const std::string text = summarize(readProgram(
        "M83\nG1 Z.2\nG1 X9 E4\n; estimated printing time (normal mode) = 1h 5m 24s\n; total filament used [g] = "
        "3.5\n; "
        "filament_type = PLA;PETG\n; nozzle_diameter = 0.4,0.6\n; printer_model = MK4\n; layer_height = 0.2\n; "
        "first_layer_height = 0.25\n"));
    EXPECT_TRUE(
        text.starts_with("the file says: 1 h 5 min 24 s, 3.5 g, PLA, nozzle 0.4 mm, MK4, layers of 0.2 mm, the "
                         "first 0.25 mm\n"))
        << text;
    EXPECT_EQ(summarize(readProgram("M83\nG1 Z.2\nG1 X9 E4\n")).find("the file says"), std::string::npos);
}

struct CorpusFacts {
    const char* file;
    std::optional<double> seconds;
    std::optional<double> grams;
    std::vector<std::string> materials;
    std::vector<double> nozzles;
    const char* printer;
    std::optional<double> layer_height;
    std::optional<double> first_layer_height;
};

class CorpusStated : public testing::TestWithParam<CorpusFacts> {};

TEST_P(CorpusStated, IsWhatTheFileSays) {
    const CorpusFacts& expected = GetParam();
    STRATUM_NEEDS_CORPUS(path, std::string("gcode/") + expected.file);
    const InputFile file(path);
    const StatedFacts stated = readToolpath(file.bytes(), "file").stated;
    EXPECT_EQ(stated.seconds, expected.seconds);
    EXPECT_EQ(stated.grams, expected.grams);
    EXPECT_EQ(stated.materials, expected.materials);
    EXPECT_EQ(stated.nozzle_diameters, expected.nozzles);
    EXPECT_EQ(stated.printer, expected.printer);
    EXPECT_EQ(stated.layer_height, expected.layer_height);
    EXPECT_EQ(stated.first_layer_height, expected.first_layer_height);
}

constexpr auto kNone = std::nullopt;

INSTANTIATE_TEST_SUITE_P(
    Files, CorpusStated,
    testing::Values(
        CorpusFacts{"Printrun-testgeometry.gcode", 4441, kNone, {"PLA"}, {.4}, "COREONE", .15, .35},
        CorpusFacts{
            "preprocess_cancellation-superslicer.gcode", 439, .67, {"ABS"}, {.4}, "Voron_v2_300_aferburner", .2, .2},
        CorpusFacts{
            "slicer-meta-orca_twocolors.gcode.3mf", 2803, 11.37, {"PLA", "PLA"}, {.4}, "Flashforge AD5X", .16, .2},
        CorpusFacts{"slicercompare-bambu_plate_1.gcode", 696, kNone, {"PLA"}, {.4}, "Bambu Lab X1 Carbon", .2, .2},
        CorpusFacts{"filaswitch-mc_testmodel1_Cura.gcode", 2656, kNone, {}, {}, "", .2, kNone},
        CorpusFacts{"filaswitch-mc_testmodel1_S3D.gcode",
                    2580,
                    8.14,
                    {"PLA"},
                    {.4, .4, .4, .4, .4},
                    "Cube/Prometheus4x/filaswitch/Duet",
                    .2,
                    .2},
        CorpusFacts{"slicer-meta-FlashPrint.gx", 892, kNone, {"PLA"}, {}, "Adventurer 4 Series", .2, kNone},
        CorpusFacts{"slicer-meta-flashprint_2.4.4.gcode", kNone, kNone, {"PLA"}, {}, "Adventurer 5M Pro", .2, kNone},
        CorpusFacts{"preprocess_cancellation-ideamaker.gcode", 744, kNone, {}, {}, "", kNone, kNone},
        CorpusFacts{"preprocess_cancellation-kirimoto.gcode", 806, kNone, {}, {}, "Voron V2.4 300mm", .2, .25},
        CorpusFacts{"RepRapFirmware-SD-benchy_pathio.gcode", 4908, kNone, {}, {.4}, "Generic/Custom", kNone, kNone},
        CorpusFacts{"preprocess_cancellation-slic3r.gcode", kNone, kNone, {}, {.4}, "", .3, .4},
        CorpusFacts{"gcode_metadata-cura_2ext.ufp", 1554, kNone, {"PLA", "PLA"}, {}, "", .1, kNone}));

}  // namespace
}  // namespace stratum::gcode
