#include "study/cost/need.h"

#include "corpus.h"
#include "scratch_folder.h"
#include "study/report/result_table.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    EXPECT_EQ(report.rows, 16U);
    std::ifstream file(report.csv);
    std::map<std::string, Row> rows;
    for (std::string line; std::getline(file, line);) {
        const Row row = parseCsvLine(line);
        rows[row.at(2)] = row;
    }
    const auto peak = [&](const char* name) { return std::stod(rows.at(name).at(7)); };
    // What was counted while all is off is told, and what is over the limit found.
    std::ofstream(folder.path() / "need_off.csv") << "work,capability,functions,instructions,percent,run\n"
                                                     "picture,lens,1,12,0.01,1\npicture,denoiser,1,9000,2.5,1\n";
    // Two grids of four bytes a voxel, and a table of 90 x 90 x 180 colours: both must show. The first process of all
    // may have more of the program's own file mapped, when that is just being read: the smaller of two counts.
    const double least = std::min(peak("none"), peak("none, once more"));
    EXPECT_GT(peak("attribute grids"), least * 1.1);
    EXPECT_GT(peak("measured material"), least + 12.0 * 90 * 90 * 180 * 0.9);
    const StudyReport again = studyNeed(options, common);
    EXPECT_EQ(again.resumed, 16U);
    ASSERT_EQ(again.findings.size(), 1U);
    EXPECT_NE(again.findings[0].find("denoiser"), std::string::npos);
    // One of an older version is not shown.
    std::ofstream(folder.path() / "need_off.csv") << "capability,functions,instructions,percent\ndenoiser,2,9000,2.5\n";
    const StudyReport older = studyNeed(options, common);
    ASSERT_EQ(older.findings.size(), 1U);
    EXPECT_NE(older.findings[0].find("older"), std::string::npos);
}

}  // namespace
}  // namespace stratum::study
