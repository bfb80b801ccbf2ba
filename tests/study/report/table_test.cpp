#include "study/report/table.h"

#include "base/error.h"
#include "base/own_file.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stratum::study {
namespace {

TEST(Table, HasCellsByTheirColumns) {
    Table table("print,mm");
    table.add({"a", "0.25"});
    table.add({"b", ""});
    EXPECT_EQ(table.text(table.rows()[0], "print"), "a");
    EXPECT_EQ(table.number(table.rows()[0], "mm"), 0.25);
    EXPECT_TRUE(std::isnan(table.number(table.rows()[1], "mm")));
    EXPECT_THROW((void)table.text(table.rows()[0], "cm"), std::out_of_range);
}

TEST(Table, IsAFileThatTheNextStudyMayReplace) {
    const test::ScratchFolder folder;
    Table table("key,value");
    table.add({"a, b", "x \"y\""});
    table.write(folder / "t.csv");
    EXPECT_EQ(test::bytesOf(folder / "t.csv"),
              "key,value,made_by\n\"a, b\",\"x \"\"y\"\"\",vdbstudy " STRATUM_VERSION "\n");
    EXPECT_TRUE(isOwnFile(folder / "t.csv"));
    EXPECT_THROW(table.write(folder / "no" / "t.csv"), OutputError);
}

TEST(Table, ReadsTheLinesThatItWrites) {
    const Row row{"", "a,b", "\"", "plain", "two\nlines"};
    EXPECT_EQ(parseCsvLine(csvLine(row)), row);
    EXPECT_EQ(parseCsvLine("1,,3"), (Row{"1", "", "3"}));
}

TEST(Figure, HasFiveDigitsOrAllOfAWholeNumber) {
    EXPECT_EQ(figures({1.0 / 3, 12345678901.0, 2.0, std::numeric_limits<double>::quiet_NaN()}),
              (Row{"0.33333", "12345678901", "2", ""}));
}

}  // namespace
}  // namespace stratum::study
