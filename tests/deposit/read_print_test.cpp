#include "deposit/read_print.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stratum::deposit
