#include "study/report/result_table.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace stratum::study {
namespace {

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(ResultTable, GoesOnWithTheRowsItHas) {
    const test::ScratchFolder folder;
    const Row columns{"print", "size", "value"};
    {
        ResultTable table(folder / "t.csv", columns, 2);
        table.add({"a, b", "1", "x \"y\"\nz"});
        EXPECT_EQ(table.find({"a, b", "2"}), nullptr);
    }
    ResultTable table(folder / "t.csv", columns, 2);
    EXPECT_EQ(table.resumed(), 1U);
    ASSERT_NE(table.find({"a, b", "1"}), nullptr);
    EXPECT_EQ(table.find({"a, b", "1"})->back(), "x \"y\"\nz");
    table.add({"c", "1", "2"});
    EXPECT_EQ(table.rows().size(), 2U);
}

TEST(ResultTable, CutsOffALineThatACrashLeft) {
    const test::ScratchFolder folder;
    const auto path = folder / "t.csv";
    std::ofstream(path) << "key,value\n1,2\n3,";
    {
        ResultTable table(path, {"key", "value"}, 1);
        EXPECT_EQ(table.rows().size(), 1U);
        table.add({"3", "4"});
    }
    EXPECT_EQ(textOf(path), "key,value\n1,2\n3,4\n");
}

TEST(ResultTable, RefusesAnotherStudysFileUnlessToldToStartOver) {
    const test::ScratchFolder folder;
    const auto path = folder / "t.csv";
    std::ofstream(path) << "other\n1\n";
    EXPECT_THROW(ResultTable(path, {"key", "value"}, 1), UsageError);
    EXPECT_EQ(textOf(path), "other\n1\n");
    const ResultTable table(path, {"key", "value"}, 1, true);
    EXPECT_EQ(textOf(path), "key,value\n");
    std::ofstream(path) << "key,value\n1\n";
    EXPECT_THROW(ResultTable(path, {"key", "value"}, 1), UsageError);
    EXPECT_THROW(ResultTable(folder / "no" / "t.csv", {"key"}, 1), OutputError);
}

TEST(ResultTable, ReadsWhatItWrites) {
    const Row row{"", "a,b", "\"", "plain", "two\nlines"};
    EXPECT_EQ(parseCsvLine(csvLine(row)), row);
    EXPECT_EQ(parseCsvLine("1,,3"), (Row{"1", "", "3"}));
}

}  // namespace
}  // namespace stratum::study
