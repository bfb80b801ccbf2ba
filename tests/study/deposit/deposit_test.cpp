#include "study/study.h"

#include "corpus.h"
#include "scratch_folder.h"
#include "study/deposit/deposit_parts.h"
#include "study/report/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <string>

namespace stratum::study {
namespace {

// By their keys, columns by name.
std::vector<std::map<std::string, std::string>> namedRows(const std::filesystem::path& csv) {
    std::ifstream file(csv);
    std::string line;
    std::getline(file, line);
    const Row columns = parseCsvLine(line);
    std::vector<std::map<std::string, std::string>> rows;
    while (std::getline(file, line)) {
        const Row cells = parseCsvLine(line);
        auto& row = rows.emplace_back();
        for (std::size_t n = 0; n < columns.size(); ++n) row[columns[n]] = cells.at(n);
    }
    return rows;
}

double numberOf(const std::map<std::string, std::string>& row, const char* column) { return std::stod(row.at(column)); }

class Deposit : public testing::Test {
protected:
    // Once for all: the folder is named after the test that comes first.
    void SetUp() override {
        if (folder_) return;
        folder_ = std::make_unique<test::ScratchFolder>();
        common_.folder = folder_->path();
        common_.quick = true;
        common_.command = {"vdbstudy"};
        options_.prints = {(test::dataDir() / "gcode" / "tile.gcode").string()};
        options_.timed = {(test::dataDir() / "gcode" / "bridges_cura.gcode").string()};
        options_.layers = "1:4";
        report_ = studyDeposit(options_, common_);
    }
    static void TearDownTestSuite() { folder_.reset(); }
    static auto rows(const char* name) { return namedRows(*folder_ / name); }

    static std::unique_ptr<test::ScratchFolder> folder_;
    static StudyOptions common_;
    static DepositOptions options_;
    static StudyReport report_;
};
std::unique_ptr<test::ScratchFolder> Deposit::folder_;
StudyOptions Deposit::common_;
DepositOptions Deposit::options_;
StudyReport Deposit::report_;

TEST_F(Deposit, SettledBeadsHoldWhatUnionsLose) {
    std::map<std::string, double> of_fed;
    for (const auto& row : rows("deposit_volume.csv")) {
        EXPECT_NEAR(numberOf(row, "rest_percent"), 0, 2.5) << row.at("print") << " " << row.at("beads_are");
        of_fed[row.at("print") + ", " + row.at("beads_are")] = numberOf(row, "of_fed_percent");
    }
    ASSERT_EQ(of_fed.size(), 9U);
    EXPECT_LT(of_fed["tile.gcode, union"] + 1, of_fed["tile.gcode, settled"]);
    EXPECT_LT(of_fed["tile.gcode, settled"], 0);  // there is a surplus, which has no place
    EXPECT_NEAR(of_fed["VOLCO's tile, parallel, settled, flow"], 0, 0.6);
    // Half discs at the ends of lines are more than was fed: 24 of 0.45 mm.
    EXPECT_GT(of_fed["VOLCO's tile, parallel, settled"], 2);
}

TEST_F(Deposit, RoughnessIsThatOfTheSection) {
    const auto walls = rows("deposit_roughness.csv");
    ASSERT_EQ(walls.size(), 6U);
    std::map<std::string, double> ra;
    for (const auto& row : walls) {
        // Corners of half that radius are a voxel here, which is too coarse for them.
        EXPECT_NEAR(numberOf(row, "ra_um") / numberOf(row, "shape_ra_um"), 1,
                    row.at("section_percent") == "100" ? 0.06 : 0.45)
            << row.at("layer_mm");
        EXPECT_GE(numberOf(row, "ra_high_um"), numberOf(row, "ra_um"));
        EXPECT_LE(numberOf(row, "ra_low_um"), numberOf(row, "ra_um"));
        ra[row.at("layer_mm") + " " + row.at("section_percent") + " " + row.at("flow_percent")] =
            numberOf(row, "ra_um");
    }
    EXPECT_NEAR(ra["0.2 100 100"] / ra["0.1 100 100"], 2, 0.1);
    EXPECT_LT(ra["0.2 50 100"], 0.6 * ra["0.2 100 100"]);
    EXPECT_NEAR(ra["0.2 100 110"] / ra["0.2 100 100"], 1, 0.03);
}

TEST(WallRoughness, IsTheClosedFormForStadiums) {
    // See tests/report/walls/roughness_test.cpp.
    const double mean = std::numbers::pi / 4;
    const double a = std::sqrt(1 - mean * mean);
    EXPECT_NEAR(wallRoughness(0.2, 0.1), 0.1 * (a * mean + std::asin(a) - 2 * a * mean), 1e-7);
    // With almost no corners there is almost no groove; for small radii it goes with their square.
    EXPECT_NEAR(wallRoughness(0.2, 0.002) / wallRoughness(0.2, 0.001), 4, 0.05);
}

TEST_F(Deposit, CornersBulgeWithTheLagAndNotWithItsAdvance) {
    std::map<std::string, double> width;
    for (const auto& row : rows("deposit_corner.csv"))
        width[row.at("jerk_mm_s") + " " + row.at("lag_s") + " " + row.at("advance_s")] = numberOf(row, "width_ratio");
    ASSERT_EQ(width.size(), 6U);
    for (const char* jerk : {"1", "8"}) {
        const std::string head = jerk;
        EXPECT_NEAR(width[head + " 0 0"], 1, 1e-3);
        EXPECT_NEAR(width[head + " 0.05 0.05"], 1, 1e-3);
        EXPECT_GT(width[head + " 0.05 0"], 1.1);
    }
    EXPECT_GT(width["1 0.05 0"], width["8 0.05 0"]);  // it slows down more
    for (const std::string& finding : report_.findings) EXPECT_EQ(finding.find("a corner"), std::string::npos);
}

TEST_F(Deposit, TimesAreThoseOfTheFiles) {
    const auto times = rows("deposit_time.csv");
    ASSERT_EQ(times.size(), 2U);
    EXPECT_EQ(times[0].at("status"), "ok");
    EXPECT_NEAR(numberOf(times[0], "off_percent"), 0, 3);  // PrusaSlicer's own rule
    EXPECT_GT(numberOf(times[1], "planned_s"), 0);
    // CuraEngine's 6666 s are no time; its clock behind the layers is.
    EXPECT_NEAR(numberOf(times[1], "off_percent"), 0, 5);
}

}  // namespace
}  // namespace stratum::study
