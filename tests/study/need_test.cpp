#include "study/need.h"

#include "corpus.h"
#include "scratch_folder.h"
#include "study/result_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

namespace stratum::study {
namespace {

TEST(Need, SwitchesEachCapabilityOnAlone) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    common.quick = true;
    const NeedOptions options{{(test::dataDir() / "gcode" / "tile.gcode").string()}, 1};
    const StudyReport report = studyNeed(options, common);
    EXPECT_EQ(report.rows, 11U);
    std::ifstream file(report.csv);
    std::map<std::string, Row> rows;
    for (std::string line; std::getline(file, line);) {
        const Row row = parseCsvLine(line);
        rows[row.at(2)] = row;
    }
    const auto peak = [&](const char* name) { return std::stod(rows.at(name).at(7)); };
    // Two grids of four bytes a voxel, and a table of 90 x 90 x 180 colours: both must show.
    EXPECT_GT(peak("attribute grids"), peak("none") * 1.1);
    EXPECT_GT(peak("measured material"), peak("none") + 12.0 * 90 * 90 * 180 * 0.9);
    EXPECT_EQ(studyNeed(options, common).resumed, 11U);
}

}  // namespace
}  // namespace stratum::study
