#include "gcode/container/package_facts.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"
#include "gcode/slicer/bead_colors.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace stratum::gcode {
namespace {

const std::string kSliceInfo =
    "<?xml version=\"1.0\"?>\n<config>\n<plate>\n<metadata key=\"index\" value=\"1\"/>\n<object identify_id=\"9\" "
    "name=\"other\" skipped=\"false\" />\n</plate>\n<plate>\n<metadata key=\"index\" value=\"2\"/>\n<metadata "
    "key=\"prediction\" value=\"1698\"/>\n<metadata key=\"weight\" value=\"5.35\"/>\n<metadata "
    "key=\"printer_model_id\" value=\"A &amp; B\"/>\n<object identify_id=\"15\" name=\"gear &lt;1&gt;.stl\" "
    "/>\n<object "
    "identify_id=\"7\" name=\"cube\"/>\n<object identify_id=\"8\" name=\"cube\"/>\n<filament id=\"2\" type=\"PETG\" "
    "color=\"#00C1AE\" />\n</plate>\n</config>\n";

TEST(PackageFacts, OfThePlateThatIsRead) {
    const PackageFacts facts = readSliceInfo(kSliceInfo, 2);
    EXPECT_EQ(facts.stated.seconds, 1698);
    EXPECT_EQ(facts.stated.grams, 5.35);
    EXPECT_EQ(facts.stated.printer, "A & B");
    EXPECT_EQ(facts.stated.materials, (std::vector<std::string>{"", "PETG"}));
    EXPECT_EQ(facts.filament_colors, (std::vector<std::optional<Rgb>>{std::nullopt, Rgb{0, 0xc1, 0xae}}));
    ASSERT_EQ(facts.object_names.size(), 3U);
    EXPECT_EQ(facts.object_names[0].second, "gear <1>.stl");
    EXPECT_EQ(readSliceInfo(kSliceInfo, 1).object_names.size(), 1U);
    EXPECT_TRUE(readSliceInfo(kSliceInfo, 3).object_names.empty());
    for (std::size_t size = 0; size < kSliceInfo.size(); ++size) readSliceInfo(kSliceInfo.substr(0, size), 2);
}

TEST(PackageFacts, TagsWithoutAnEndTakeNoTime) {
    std::string xml = "<plate><metadata key=\"index\" value=\"1\"/>";
    for (int n = 0; n < 100000; ++n) xml += "<object i";
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(readSliceInfo(xml + "</plate>", 1).object_names.empty());
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));  // 50 s by the rest of the text
}

TEST(PackageFacts, ObjectsOfBambuStudioHaveTheirNames) {
    std::string text = "M83\nG1 Z.2\n";
    for (const int id : {15, 7, 8, 99})
        text += "; start printing object, unique label id: " + std::to_string(id) + "\nG1 X" + std::to_string(id) +
                " E1\n; stop printing object, unique label id: " + std::to_string(id) + "\n";
    const Toolpath toolpath =
        readProgram(sample::zip({{"Metadata/slice_info.config", kSliceInfo}, {"Metadata/plate_2.gcode", text}}));
    EXPECT_EQ(toolpath.objects,
              (std::vector<std::string>{"", "gear <1>.stl", "cube 7", "cube 8", "unique label id: 99"}));
    EXPECT_EQ(toolpath.stated.seconds, 1698);
    EXPECT_EQ(toolpath.tool_colors.size(), 2U);
}

TEST(PackageFacts, TheTextGoesBefore) {
    const std::string text =
        "M83\nG1 Z.2\nG1 X9 E1\n; estimated printing time (normal mode) = 7s\n; filament_colour = #010203\n";
    const Toolpath toolpath =
        readProgram(sample::zip({{"Metadata/slice_info.config", kSliceInfo}, {"Metadata/plate_2.gcode", text}}));
    EXPECT_EQ(toolpath.stated.seconds, 7);
    EXPECT_EQ(toolpath.tool_colors, (std::vector<std::optional<Rgb>>{Rgb{1, 2, 3}}));
}

TEST(PackageFacts, AUfpNamesItsMaterials) {
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode_metadata-cura_2ext.ufp");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ufp");
    ASSERT_EQ(toolpath.tool_colors.size(), 2U);
    EXPECT_EQ(toolpath.tool_colors[1], (Rgb{0xbb, 0x1e, 0x10}));  // ultimaker_pla_red
    ASSERT_TRUE(toolpath.tool_colors[0].has_value());
    EXPECT_GT((*toolpath.tool_colors[0])[1], (*toolpath.tool_colors[0])[0]);  // green
}

}  // namespace
}  // namespace stratum::gcode
