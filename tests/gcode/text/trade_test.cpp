#include "gcode/text/trade.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

TEST(Trade, SaysWhatProgramsWithoutFilamentAre) {
    struct Case {
        const char* program;
        const char* what;
    };
    const Case cases[] = {
        {"G21\nM4 S0\nG0 X5\nG1 X10 S400 F1000\nM5\n", "laser"},
        {"; LightBurn 1.4\nG0 X5\nG1 X9\n", "laser"},
        {"G21\nT1 M6\nM3 S12000\nG0 Z5\nG1 Z-1 F100\nG1 X10\nM5\n", "mill or router"},
        {"G90\nG43 H1\nG81 X1 Y1 Z-2 R2 F80\n", "mill or router"},
        {"M280 P0 S40\nG1 X9\nM280 P0 S90\n", "pen plotter"},
        {"G20\nM03 ;(Torch mode on)\nG1 X5\nM05\n", "another cutting machine"},
        {"M3 S30 ; pen down\nG1 X9\n", "pen plotter"},
        {"M104 S{first_layer_temperature[0]}\nG28\n", "line 1 has {first_layer_temperature[0]}"},
        {"M104 S200\nM6 T0\nG43 H1\n", "mill or router"},
        {"M140 S0\nM143 H0 S{global.max_bed}\n", "a macro: line 2 has {global.max_bed}"},
        {"G1 Z{move.axes[2].max - 5}\n", "which RepRapFirmware computes"},
        {"G28\n;{comment}\nM140 S[first_layer_bed_temperature]\n", "line 3 has [first_layer_bed_temperature]"},
    };
    for (const Case& c : cases) {
        EXPECT_NE(describeTrade(c.program).find(c.what), std::string::npos) << c.program << describeTrade(c.program);
        EXPECT_NE(inputErrorOf(c.program).find(c.what), std::string::npos) << c.program;
    }
    for (const auto* program :
         {"G28\nG1 X10\n", "", "no program", "{\n}\n", "G91\nG1 H2 Z3\nG1 H1 Y-400\nG1 H2 Z-3\nG90\n",
          "M109 R240\nG1 X10 Z-.5\n", "G161 Z F900\nG92 A0 B0\nG1 X100 Y100 Z-100\n"})
        EXPECT_EQ(describeTrade(program), "");
}

}  // namespace
}  // namespace stratum::gcode
