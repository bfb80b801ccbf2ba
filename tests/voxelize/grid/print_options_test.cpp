#include "voxelize/grid/print_options.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::voxelize {
namespace {

double cornerOf(const std::string& text, double height = 0.2) {
    gcode::DepositModel deposit;
    deposit.corner_mm = 3;  // of an option before this one
    parseSection(text, deposit);
    return deposit.cornerRadius(height);
}

TEST(PrintOptions, ReadsSections) {
    EXPECT_EQ(cornerOf("stadium"), 0.1);
    EXPECT_EQ(cornerOf("100%"), 0.1);
    EXPECT_EQ(cornerOf("50%"), 0.05);
    EXPECT_EQ(cornerOf("0.03"), 0.03);
    EXPECT_EQ(cornerOf("0"), 0);
    EXPECT_EQ(cornerOf("7"), 0.1);
}

TEST(PrintOptions, RefusesOtherSections) {
    for (const char* text : {"", "%", "-1", "-5%", "101%", "1e300", "nan", "inf", "0.05mm", "round", "50%%", "5 %"}) {
        try {
            cornerOf(text);
            ADD_FAILURE() << "'" << text << "' was taken";
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find("corner radius in mm"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace stratum::voxelize
