#include "deposit/limits/printer_text.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace stratum::deposit {
namespace {

TEST(PrinterText, ReadsAFileThatIsAsSmallAsAPrinters) {
    const test::ScratchFolder folder;
    const std::string path = folder / "a";
    std::ofstream(path) << std::string(kLargestPrinterFile, 'x');
    EXPECT_EQ(readPrinterText(path, path).size(), kLargestPrinterFile);
    std::ofstream(path, std::ios::app) << 'x';
    EXPECT_THROW(readPrinterText(path, path), InputError);
    EXPECT_THROW(readPrinterText(folder.path(), "a place"), InputError);
    EXPECT_THROW(readPrinterText(folder / "b", "a place"), InputError);
}

TEST(PrinterText, NumbersAreTheWholeText) {
    EXPECT_EQ(numberIn(" +1.5e2\t", {0, 1000}, "p:1", "x"), 150);
    EXPECT_EQ(numberIn("0", {0, 1000}, "p:1", "x"), 0);
    for (const char* text : {"", " ", "1 2", "0x10", "1e999", "-1", "1001", "nan", "inf", "1,5", "++1", "one"})
        EXPECT_THROW(numberIn(text, {0, 1000}, "p:1", "x"), InputError) << text;
    EXPECT_THROW(checkLimit(gcode::Limit::speed, 0, "p:1", "x"), InputError);
    EXPECT_NO_THROW(checkLimit(gcode::Limit::jerk, 0, "p:1", "x"));
}

}  // namespace
}  // namespace stratum::deposit
