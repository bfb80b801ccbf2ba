#include "gcode/machine/bead_recorder.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace stratum::gcode {
namespace {

// Marks by people's own programs: where layers are not level they count, else z does.
TEST(BeadRecorder, PlainMarksCountWhereLayersAreNotLevel) {
    std::string tilted = "M83\n";
    std::string level = "M83\n;layer 0\nG1 X0 Y5 Z.2\nG1 X9 E1\n";
    for (int n = 0; n < 4; ++n) {
        tilted += "; layer " + std::to_string(n) + "\n; layer filling\n";
        for (int k = 0; k < 9; ++k)
            tilted += "G1 X" + std::to_string(10 * (k % 2)) + " Y" + std::to_string(k) + " Z" +
                      std::to_string(1 + n * 0.3 + k * 0.5 + 0.1 * (k % 2)) + " E1\n";
        level += ";layer\n";
    }
    EXPECT_EQ(readProgram(tilted).layer_count, 4U);
    EXPECT_EQ(readProgram(level + "G1 Z.4\nG1 X0 E1\n").layer_count, 2U);
}

// OrcaSlicer's marks for its own printers and for Bambu's, one behind the other.
TEST(BeadRecorder, AnObjectThatIsMarkedTwiceIsOne) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\n; printing object a.stl id:4 copy 0\n; start printing object, unique label id: 16\nG1 X10 E1\n"
        "; stop printing object a.stl id:4 copy 0\n; stop printing object, unique label id: 16\n"
        "; printing object b.stl id:5 copy 0\n; start printing object, unique label id: 17\nG1 X20 E1\n"
        "; stop printing object b.stl id:5 copy 0\n; printing object a.stl id:4 copy 0\n"
        "; stop printing object, unique label id: 17\n; start printing object, unique label id: 16\nG1 X30 E1\n");
    EXPECT_EQ(toolpath.objects, (std::vector<std::string>{"", "a.stl id:4 copy 0", "b.stl id:5 copy 0"}));
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).object, 1);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).object, 2);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[2]).object, 1);
}

// Where comments mark objects, macros don't: one that a macro has begun ends there.
TEST(BeadRecorder, AnObjectOfAMacroEndsWhereCommentsBegin) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nEXCLUDE_OBJECT_START NAME=part\n; start printing object, unique label id: 15\nG1 X10 E1\n"
        "; stop printing object, unique label id: 15\nEXCLUDE_OBJECT_END NAME=part\nG1 X20 E1\n");
    EXPECT_EQ(toolpath.objects[toolpath.runOf(toolpath.beads[0]).object], "unique label id: 15");
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).object, 0);
}

std::vector<std::uint32_t> layersOf(const Toolpath& toolpath) {
    std::vector<std::uint32_t> layers;
    for (const Bead& bead : toolpath.beads) layers.push_back(toolpath.runOf(bead).layer);
    return layers;
}

using Layers = std::vector<std::uint32_t>;

TEST(BeadRecorder, LayersByMarks) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.3\nG1 X9 E1 ; prime line\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z.2\nG1 X0 E1\n;LAYER_CHANGE\nG1 Z.4\nG1 "
        "X9 "
        "E1\n");
    EXPECT_EQ(layersOf(toolpath), (Layers{0, 1, 2}));
    EXPECT_EQ(toolpath.layer_count, 2U);
}

TEST(BeadRecorder, CurasMarksCountFromOne) {
    const Toolpath toolpath =
        readProgram("M83\n;LAYER:-1\nG1 Z.2\nG1 X9 E1\n;LAYER:0\nG1 Z.4\nG1 X0 E1\n;LAYER:1\nG1 Z.6\nG1 X9 E1\n");
    EXPECT_EQ(layersOf(toolpath), (Layers{1, 2, 3}));
}

TEST(BeadRecorder, LayersByExtrudedZWithoutMarks) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nG1 X9 E1\nG1 Z1\nG0 X5\nG1 Z.2\nG1 X0 E1\nG1 Z.4\nG1 X9 E1\nG1 Z.2\nG1 X0 E1\nG1 Z.4\nG1 X9 "
        "E1\n");
    // A hop counts nothing; the return to the first layer's z begins the next object.
    EXPECT_EQ(layersOf(toolpath), (Layers{1, 1, 2, 3, 4}));
}

TEST(BeadRecorder, ASpiralsLayersAreNominalHeights) {
    std::string program = "M83\nG1 Z.2\n; layer_height = 0.2\n";
    for (int i = 1; i <= 40; ++i)
        program += "G1 X" + std::to_string(i % 2) + " Z" + std::to_string(0.2 + 0.02 * i) + " E.1\n";
    EXPECT_EQ(readProgram(program).layer_count, 4U);  // 0.22 up to 1.0
}

// A damaged coordinate: 100 m of a thread that no nozzle draws. Long lines of plastic stay.
TEST(BeadRecorder, AThreadOfAHundredMetresIsLeftOut) {
    const Toolpath damaged = readProgram("M83\nG1 Z.2\nG1 X9 E1\nG1 X99999 E.03\nG1 X9 E.03\nG1 X0 E1\n");
    EXPECT_EQ(damaged.beads.size(), 2U);
    const auto told = [](const Toolpath& toolpath) {
        return std::any_of(toolpath.warnings.begin(), toolpath.warnings.end(), [](const Warning& warning) {
            return warning.text.find("thinner than 0.02 mm") != std::string::npos && warning.count == 2;
        });
    };
    EXPECT_TRUE(told(damaged));
    const Toolpath large = readProgram("M83\nG1 Z.2\nG1 X9 E1\nG1 X9999 E330\nG1 X9 E330\nG1 X0 E1\n");
    EXPECT_EQ(large.beads.size(), 4U);
    EXPECT_FALSE(told(large));
}

TEST(BeadRecorder, ARunIsWhatNeighboursShare) {
    const Toolpath toolpath = readProgram(
        "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\n;TYPE:Perimeter\nG1 Z.2 F600\nG1 X9 E1\nG1 X8 E1\nG1 X7 E1 "
        "F1200\n;TYPE:Internal "
        "infill\n;TYPE:Perimeter\nG1 X6 E1\nT2\nG1 X5 E1\n");
    ASSERT_EQ(toolpath.runs.size(), 3U);
    EXPECT_EQ(toolpath.runs[0], (gcode::Run{.height = 0.2F, .speed = 10, .layer = 1, .feature = Feature::perimeter}));
    EXPECT_EQ(toolpath.runs[1].speed, 20.0F);
    EXPECT_EQ(toolpath.runs[2].tool, 2);
    EXPECT_EQ(toolpath.beads[1].run, 0U);
    EXPECT_EQ(toolpath.beads[3].run, 1U);
}

TEST(BeadRecorder, HeightTagsLoseTheirFloatNoise) {
    const Toolpath toolpath = readProgram("M83\n;LAYER_CHANGE\n;HEIGHT:0.199999\nG1 Z.2\nG1 X9 E1\n");
    EXPECT_EQ(toolpath.runs[0].height, 0.2F);
}

TEST(BeadRecorder, Objects) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\n; printing object a id:0 copy 0\nG1 X1 E1\n; stop printing object a id:0 copy 0\nG1 X2 E1\n; "
        "printing "
        "object b\nG1 X3 E1\n; printing object a id:0 copy 0\nG1 X4 E1\n");
    EXPECT_EQ(toolpath.objects, (std::vector<std::string>{"", "a id:0 copy 0", "b"}));
    std::vector<int> objects;
    for (const Bead& bead : toolpath.beads) objects.push_back(toolpath.runOf(bead).object);
    EXPECT_EQ(objects, (std::vector<int>{1, 0, 2, 1}));
}

TEST(BeadRecorder, ObjectsByCommand) {
    const Toolpath m486 =
        readProgram("M83\nM486 T2\nG1 Z.2\nM486 S0\nG1 X1 E1\nM486 S-1\nG1 X2 E1\nM486 S1\nG1 X3 E1\n");
    EXPECT_EQ(m486.objects, (std::vector<std::string>{"", "object 0", "object 1"}));
    const Toolpath klipper = readProgram(
        "M83\nG1 Z.2\nEXCLUDE_OBJECT_START NAME=cube_1\nG1 X1 E1\nEXCLUDE_OBJECT_END NAME=cube_1\nG1 X2 E1\n");
    EXPECT_EQ(klipper.objects, (std::vector<std::string>{"", "cube_1"}));
    EXPECT_EQ(klipper.runOf(klipper.beads[1]).object, 0);
    EXPECT_EQ(warningCount(klipper, "macro"), 0U);
}

TEST(BeadRecorder, UnknownFeatureNamesAreRemarked) {
    const Toolpath toolpath = readProgram("M83\n;TYPE:Wobble\nG1 Z.2\nG1 X9 E1\n");
    EXPECT_EQ(warningCount(toolpath, "Wobble"), 1U);
    EXPECT_EQ(toolpath.runs[0].feature, Feature::unknown);
}

TEST(BeadRecorder, Slic3rNamesAMoveBehindIt) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E1 ; perimeter\nG1 X8 E1 ; infill\n");
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).feature, Feature::perimeter);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).feature, Feature::infill);
}

TEST(BeadRecorder, TwoMarksOfOneLayerCountOnce) {
    // The slicer's own, and one that its user asked for.
    const Toolpath toolpath =
        readProgram("M83\n;LAYER_CHANGE\n;LAYER:0\nG1 Z.2\nG1 X9 E1\n;LAYER_CHANGE\n;LAYER:1\nG1 Z.4\nG1 X0 E1\n");
    EXPECT_EQ(layersOf(toolpath), (Layers{1, 2}));
    // Empty layers are layers.
    EXPECT_EQ(layersOf(readProgram("M83\n;LAYER:0\n;LAYER:1\nG1 Z.2\nG1 X9 E1\n")), (Layers{2}));
    EXPECT_EQ(layersOf(readProgram("M83\n; BEGIN_LAYER_OBJECT z=0.3 z_thickness=0.3\nG1 Z.3\nG1 X9 E1\n; layer 1, Z = "
                                   "0.3\nG1 X0 E1\n; BEGIN_LAYER_OBJECT z=0.6\nG1 Z.6\nG1 X9 E1\n")),
              (Layers{1, 1, 2}));
}

TEST(BeadRecorder, TheStartProgramIsNoLayer) {
    EXPECT_EQ(layersOf(readProgram("M83\nG1 Z.3\nG1 X9 E9\nG21 ; set units to millimeters\nG1 Z.2\nG1 X0 E1\nG1 "
                                   "Z.4\nG1 X9 E1\n")),
              (Layers{0, 1, 2}));
    EXPECT_EQ(layersOf(readProgram("M83\nG1 Z.3\nG1 X9 E9\nG1 Z.2\nG1 X0 E1 ; perimeter\nG1 Z.4\nG1 X9 E1 ; "
                                   "perimeter\n")),
              (Layers{0, 1, 2}));
    EXPECT_EQ(layersOf(readProgram("M83\nG21\nG1 Z.3\nG1 X9 E9\nG1 Z.6\nG1 X0 E1\n")), (Layers{1, 2}));
}

TEST(BeadRecorder, AMarkBehindAllThatIsPrintedIsNone) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E1\nG1 Z.4\nG1 X0 E1\n;LAYER:0\nM84\n");
    EXPECT_EQ(layersOf(toolpath), (Layers{1, 2}));
    EXPECT_EQ(toolpath.layer_count, 2U);
}

TEST(BeadRecorder, ManyMixesTakeTimeInProportion) {
    std::string program = "M83\nG1 Z.2\n";
    for (int i = 0; i < 160000; ++i)
        program += "M165 A" + std::to_string(i % 7) + " B1\nG1 X" + std::to_string(i % 2) + " E.1\n";
    EXPECT_EQ(readProgram(program).beads.size(), 159999U);  // the first one moves nothing
}

}  // namespace
}  // namespace stratum::gcode
