#include "study/study.h"

#include "corpus.h"
#include "scratch_folder.h"
#include "study/report/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>

namespace stratum::study {
namespace {

TEST(Need, SwitchesEachCapabilityOnAlone) {
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path(), .quick = true};
    const NeedOptions options{{(test::dataDir() / "gcode" / "tile.gcode").string()}, 1};
    // What was counted while all is off is told, and what grew found.
    std::ofstream(folder.path() / "need_off.csv")
        << "work,instructions,before,percent,verdict\n"
           "conversion,1000,999,+0.100,ok\npicture,1025,1000,+2.500,over 1 %\n";
    const StudyReport report = studyNeed(options, common);
    EXPECT_EQ(report.rows, 21U);
    ASSERT_EQ(report.findings.size(), 1U);
    EXPECT_NE(report.findings[0].find("picture"), std::string::npos);
    std::ifstream file(report.csv);
    std::map<std::string, Row> rows;
    for (std::string line; std::getline(file, line);) {
        const Row row = parseCsvLine(line);
        rows[row.at(2)] = row;
    }
    const auto peak = [&](const char* name) { return std::stod(rows.at(name).at(8)); };
    // Two grids of four bytes a voxel, and a table of 90 x 90 x 180 colours: both must show. The first process of all
    // may have more of the program's own file mapped, when that is just being read: the smaller of two counts.
    const double least = std::min(peak("none"), peak("none, once more"));
    EXPECT_GT(peak("attribute grids"), least * 1.1);
    EXPECT_GT(peak("measured material"), least + 12.0 * 90 * 90 * 180 * 0.9);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_NE(entry.path().extension(), ".exr") << "the map of light is left";
}

}  // namespace
}  // namespace stratum::study
