#include "deposit/read_print.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <cmath>
#include <string>

namespace stratum::deposit {
namespace {

TEST(ReadPrint, EveryProgramTakesSomeTime) {
    const std::string head = "M83\nG1 Z0.2 F600\nG1 X10 E1 F1200\n";
    for (const char* rest :
         {"G1 F0\nG1 X20 E1\n", "G1 F0.000001\nG1 X20 E1\n", "M204 P0 T0 R0\nM201 X0 Y0 Z0 E0\nG1 X20 E1 F1200\n",
          "M205 X0 Y0 Z0 E0\nG1 X20 E1 F1200\nG1 X10 Y5 E1\n", "G4 S31536000\nG1 X20 E1\nG4 P0\n",
          "G1 X10\nG1 E0\nG1\nG1 X20 E1\n"}) {
        const PrintRead print = readPrint(head + rest, "case", {}, true);
        EXPECT_TRUE(std::isfinite(print.times->total)) << rest;
        EXPECT_GE(print.times->total, 0) << rest;
    }
}

// A printer's preset has sag, which would otherwise refuse all prints on belts.
TEST(ReadPrint, OnABeltSagIsLeftOutWithAWarning) {
    const std::string program = "G21 G90 M83\nG1 Z0.4 F600\nG1 X0 Y0\nG1 X30 E1 F1200\nG1 Y5\nG1 X0 E1\n";
    gcode::ReadOptions options;
    options.deposit.sag = 0.02;
    EXPECT_TRUE(readPrint(program, "a", options, false).sag.has_value());
    options.belt_angle = 45;
    const PrintRead read = readPrint(program, "a", options, false);
    EXPECT_FALSE(read.sag.has_value());
    EXPECT_EQ(read.toolpath.deposit.sag, 0);
    EXPECT_TRUE(std::ranges::any_of(read.toolpath.warnings, [](const gcode::Warning& warning) {
        return warning.text.find("sag is left out") != std::string::npos;
    }));
}

}  // namespace
}  // namespace stratum::deposit
