#include "study/study.h"

#include "corpus.h"
#include "scratch_folder.h"
#include "study/report/table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

namespace stratum::study {
namespace {

TEST(Render, MeasuresErrorAgainstTime) {
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path(), .quick = true};
    const RenderStudyOptions options{(test::dataDir() / "gcode" / "tile.gcode").string(), {2, 1}, 1};
    const StudyReport report = studyRender(options, common);
    std::ifstream file(report.csv);
    std::map<std::string, std::map<int, std::pair<double, double>>> errors;  // variant, spp: relMSE, against the finest
    std::size_t rows = 0;
    std::string line;
    std::getline(file, line);
    for (; std::getline(file, line); ++rows) {
        const Row row = parseCsvLine(line);
        auto& sum = errors[row.at(4)][std::stoi(row.at(5))];
        sum.first += std::stod(row.at(10));
        if (!row.at(12).empty()) sum.second += std::stod(row.at(12));
        EXPECT_GT(std::stod(row.at(8)), 0) << line;
        EXPECT_LE(std::stod(row.at(11)), row.at(4) == "ao" && row.at(5) == "4" ? 0.15 : 1) << line;
    }
    EXPECT_EQ(rows, report.rows);
    for (const char* noisy : {"brick", "vdb", "sphere", "direct", "ao", "samples apart"})
        EXPECT_LT(errors[noisy][4].first, 0.6 * errors[noisy][1].first) << noisy;
    // An integrator against another one's picture: nothing but noise is left.
    EXPECT_LT(errors["ao"][4].first, 0.02);
    EXPECT_LT(errors["brick"][4].first, errors["samples apart"][4].first);
    // Against the finer voxels something remains that is no noise.
    EXPECT_GT(errors["brick"][4].second, errors["brick"][4].first);
    const std::string text = test::bytesOf(report.html);
    EXPECT_NE(text.find("data:image/jpeg;base64"), std::string::npos);
    EXPECT_NE(text.find("<svg"), std::string::npos);
}

}  // namespace
}  // namespace stratum::study
