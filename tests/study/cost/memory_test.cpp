#include "study/study.h"

#include "base/error.h"
#include "corpus.h"
#include "scratch_folder.h"
#include "study/print.h"
#include "study/report/table.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace stratum::study {
namespace {

std::vector<Row> rowsOf(const std::filesystem::path& csv) {
    std::ifstream file(csv);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(parseCsvLine(line));
    return rows;
}

const std::string& cell(const std::vector<Row>& rows, std::size_t row, const std::string& column) {
    const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
    return rows.at(row).at(static_cast<std::size_t>(at));
}

TEST(Memory, CountsWhatAGridHolds) {
    const test::ScratchFolder folder;
    const std::string print = (test::dataDir() / "gcode" / "tile.gcode").string();
    StudyOptions common{.folder = folder.path()};
    common.command = {"vdbstudy"};
    double last = 0;
    common.progress = [&](double f) {
        EXPECT_GT(f, last);
        last = f;
    };
    const StudyReport report = studyMemory({{print}, {1, 2, 3}}, common);
    EXPECT_EQ(last, 1);
    EXPECT_EQ(report.rows, 9U);
    const auto rows = rowsOf(report.csv);
    ASSERT_EQ(rows.size(), 10U);
    // The last three: three voxels a layer, kept, culled and without a grid.
    EXPECT_EQ(cell(rows, 7, "interior"), "keep");
    const gcode::Toolpath toolpath = readPrint(print);
    const auto beads = voxelize::selectBeads(toolpath, {});
    openvdb::initialize();
    const auto grid = voxelize::voxelize(toolpath, beads, latticeOf(toolpath, beads, 3));
    EXPECT_EQ(cell(rows, 7, "active_voxels"), std::to_string(grid->activeVoxelCount()));
    EXPECT_EQ(cell(rows, 7, "leaves"), std::to_string(grid->tree().leafCount()));
    EXPECT_EQ(cell(rows, 7, "grid_bytes"), std::to_string(grid->memUsage()));
    EXPECT_LT(std::stod(cell(rows, 7, "half_file_bytes")), std::stod(cell(rows, 7, "float_file_bytes")));
    EXPECT_LT(std::stod(cell(rows, 8, "active_voxels")), std::stod(cell(rows, 7, "active_voxels")));
    for (std::size_t n = 1; n < 10; ++n) {
        const std::string grid_bytes = cell(rows, n, "grid_bytes");
        EXPECT_EQ(grid_bytes.empty(), cell(rows, n, "interior") == "keep, no grid");
        EXPECT_GT(std::stod(cell(rows, n, "peak_rss_bytes")), grid_bytes.empty() ? 0 : std::stod(grid_bytes));
    }
    // The same leaves with less memory; what a list of them takes differs.
    EXPECT_EQ(cell(rows, 9, "active_voxels"), cell(rows, 7, "active_voxels"));
    EXPECT_EQ(cell(rows, 9, "leaves"), cell(rows, 7, "leaves"));
    EXPECT_NEAR(std::stod(cell(rows, 9, "float_file_bytes")) / std::stod(cell(rows, 7, "float_file_bytes")), 1, 0.02);
    EXPECT_LT(std::stod(cell(rows, 9, "peak_rss_bytes")), std::stod(cell(rows, 7, "peak_rss_bytes")));
    // The extruded volume, by the file's own filament: 1.75 mm wide, within what prime lines take.
    EXPECT_NEAR(std::stod(cell(rows, 7, "part_mm3")), toolpath.extruded_mm3, 0.05 * toolpath.extruded_mm3);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        files += entry.is_regular_file() ? 1 : 0;
    EXPECT_EQ(files, 2U);  // table, page: no scratch is left
}

TEST(Memory, LeavesOutWhatDoesNotFit) {
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path()};
    MemoryOptions options{{(test::dataDir() / "gcode" / "tile.gcode").string()}, {2}};
    options.memory_share = 1e-9;
    const StudyReport report = studyMemory(options, common);
    EXPECT_EQ(report.findings.size(), 2U);
    EXPECT_EQ(cell(rowsOf(report.csv), 1, "status"), "left out: does not fit");
}

TEST(Memory, PassesOnWhatIsWrongWithAPrint) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "bad.gcode") << "hello\n";
    StudyOptions common{.folder = folder.path()};
    EXPECT_THROW(studyMemory({{(folder / "bad.gcode").string()}, {1}}, common), InputError);
}

}  // namespace
}  // namespace stratum::study
