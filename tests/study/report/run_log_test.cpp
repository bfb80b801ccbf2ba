#include "study/report/run_log.h"

#include "scratch_folder.h"
#include "study/report/page.h"
#include "study/report/result_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace stratum::study {
namespace {

std::size_t linesOfRuns(const std::filesystem::path& folder) {
    std::ifstream file(folder / "runs.csv");
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);) ++lines;
    return lines;
}

TEST(RunLog, RowsNameTheRunThatMeasuredThem) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    common.command = {"/home/me/bin/vdbstudy", "memory", "/data/a.gcode"};
    {
        ResultTable table(common, "t.csv", {"key", "value"}, 1);
        EXPECT_EQ(linesOfRuns(folder.path()), 1U);  // no row yet: no run
        table.add({"a", "1"});
        table.add({"two\nlines", "2"});
        table.add({"b", "3"});
        EXPECT_EQ(table.find({"a"})->back(), "1");
        EXPECT_EQ(table.columns().back(), "run");
        EXPECT_EQ(table.lineOf({"a"}), 2U);
        EXPECT_EQ(table.lineOf({"b"}), 5U);
        EXPECT_EQ(table.lineOf({"c"}), 0U);
        const Row& run = *table.runs()->find("1");
        EXPECT_EQ(run.back(), "vdbstudy memory a.gcode");
        EXPECT_EQ(run[3], machineLine());
    }
    common.command = {"vdbstudy", "memory", "b.gcode"};
    ResultTable table(common, "t.csv", {"key", "value"}, 1);
    EXPECT_EQ(table.resumed(), 3U);
    EXPECT_EQ(table.lineOf({"b"}), 5U);
    EXPECT_EQ(linesOfRuns(folder.path()), 2U);  // a run that finds all rows leaves none
    table.add({"c", "4"});
    EXPECT_EQ(table.find({"c"})->back(), "2");
    // Another table of the same run.
    ResultTable other(common, "o.csv", {"key"}, 1);
    other.add({"x"});
    EXPECT_EQ(linesOfRuns(folder.path()), 3U);
}

TEST(RunLog, PagesListTheRunsOfTheirRows) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    common.command = {"vdbstudy"};
    ResultTable table(common, "t.csv", {"key"}, 1);
    table.add({"a"});
    Page page("P", common.command);
    const std::vector<std::size_t> lines{table.lineOf({"a"})};
    page.table({"key", "run"}, table.rows(), {}, lines, "t");
    page.runs(table);
    const std::string html = page.html();
    EXPECT_NE(html.find("<tr id='t-L2'><td>a</td><td class='n'><a href='#run-1'>1</a></td>"), std::string::npos);
    EXPECT_NE(html.find("<tr id='run-1'>"), std::string::npos);
    EXPECT_NE(html.find("width=device-width"), std::string::npos);
}

}  // namespace
}  // namespace stratum::study
