#include "gcode/slicer/footer.h"

#include "gcode/reader.h"

#include <gtest/gtest.h>

#include <vector>

namespace stratum::gcode {
namespace {

using List = std::vector<double>;

Footer footerOf(std::string_view comment) {
    Footer footer;
    readFooter(comment, footer);
    return footer;
}

TEST(Footer, OfSeveralSlicers) {
    EXPECT_EQ(footerOf("filament used = 290.4mm (0.7cm3)").length, (List{290.4}));
    EXPECT_TRUE(footerOf("filament used = 22.6g").length.empty());  // Slic3r's grams, by the same words
    EXPECT_EQ(footerOf("filament used [mm] = 1.5, 2").length, (List{1.5, 2}));
    EXPECT_EQ(footerOf("Filament used: 0.5m, 0m").length, (List{500, 0}));
    EXPECT_EQ(footerOf("Filament length: 2706.2 mm (2.71 m)").length, (List{2706.2}));
    EXPECT_EQ(footerOf("Material#2 Used: 3.5").length, (List{0, 3.5}));
    EXPECT_EQ(footerOf("--- filament used: 225.03 mm ---").length, (List{225.03}));
}

// ideaMaker multiplies by its compensation, and says M221.
TEST(Footer, OfWhatIsMultipliedBesideE) {
    Footer footer;
    EXPECT_TRUE(readFooter("Filament Compensation #2: 98.000", footer));
    EXPECT_TRUE(readFooter("Material#1 Used: 100", footer));
    EXPECT_TRUE(readFooter("Material#2 Used: 9.8", footer));
    EXPECT_EQ(footer.flow, (List{0, 0.98}));
    EXPECT_EQ(footer.length, (List{100, 9.8}));
    const Toolpath toolpath = readToolpath(
        ";Filament Compensation #1: 94.00\nM221 T0 S94.00\nM83\nG1 Z.3\nG1 X10 E1\n;Material#1 Used: 0.94\n", "a");
    EXPECT_NEAR(toolpath.footer_mm, 1, 1e-12);
    EXPECT_NEAR(
        readToolpath(";Sliced by ideaMaker 4.2.0.5250, 2021-09-03\n;Filament Compensation #1: 94.00\nM83\nG1 Z.3\n"
                     "G1 X10 E1\n;Material#1 Used: 0.8836\n",
                     "a")
            .footer_mm,
        1, 1e-12);
    EXPECT_NEAR(toolpath.filament_mm, 1, 1e-12);
}

TEST(Footer, OfHeaders) {
    EXPECT_EQ(footerOf("total filament length [mm] : 325.49").length, (List{325.49}));
    EXPECT_EQ(footerOf("total filament length [mm] : 1.5,2").length, (List{3.5}));  // of the tools in use
    EXPECT_EQ(footerOf("filament_length_m = 0.2904").length, (List{290.4}));
    EXPECT_EQ(footerOf("Ext 2 =    53.49 mm  (0.378 cm^3)").length, (List{0, 53.49}));
}

TEST(Footer, Volumes) {
    EXPECT_EQ(footerOf("Filament used: 772.133mm3, 674.215mm3").volume, (List{772.133, 674.215}));
    EXPECT_TRUE(footerOf("Filament used: 772.133mm3, 674.215mm3").length.empty());
    EXPECT_EQ(footerOf("EXTRUDER_TRAIN.1.MATERIAL.VOLUME_USED:12034").volume, (List{0, 12034}));
}

// By the words that other slicers state lengths by.
TEST(Footer, GramsAreNoLengths) {
    for (const auto* comment : {"Filament used: 0.40g", "Filament used: 0.40 g", "filament used [mm] = 0.40 g",
                                "filament used = 22.6 g, 1.2 g", "Filament length: 0.40 g",
                                "--- filament used: 0.4 g ---", "Ext 1 = 0.40 g", "Material#1 Used: 0.4 kg",
                                "filament used = 22.6g (1.2 $)", "Filament used: 12 cm3", "Filament used: 3 mm3, 1 g"})
        EXPECT_TRUE(footerOf(comment).empty()) << comment;
    EXPECT_EQ(footerOf("Filament used: 40 cm, 5 mm, 0.1 m").length, (List{400, 5, 100}));
    EXPECT_EQ(footerOf("Filament used: 1.234m 9.8g").length, (List{1234}));
}

TEST(Footer, NonsenseIsNotTaken) {
    for (const auto* comment :
         {"filament used [mm] = much", "Filament used: -1m", "Material#0 Used: 4", "Material# Used: 4",
          "EXTRUDER_TRAIN.9999.MATERIAL.VOLUME_USED:1", "EXTRUDER_TRAIN.0.NOZZLE.DIAMETER:0.4", "Ext = 5 mm",
          "Ext 0 = 5 mm", "total filament length [mm] : ?", "Filament used:", "filament_diameter = 1.75"})
        EXPECT_TRUE(footerOf(comment).empty()) << comment;
}

}  // namespace
}  // namespace stratum::gcode
