// ReadOptions::flow_percent: all extrusion in per cent of what the file says.
#include "base/error.h"
#include "gcode/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace stratum::gcode {
namespace {

Toolpath readWith(double percent, const std::string& before = "") {
    ReadOptions options;
    options.flow_percent = percent;
    return readToolpath("M83\nG92 E0\nG1 Z.2 F600\n" + before + "G1 X10 E0.4 F1200\nG1 X20 E0.4\n", "flow.gcode",
                        options);
}

TEST(FlowPercent, ScalesTheVolumeOfAllBeads) {
    const double whole = beadVolume(readWith(100));
    EXPECT_GT(whole, 0);
    for (const double percent : {1.0, 90.0, 95.0, 105.0, 300.0})
        EXPECT_NEAR(beadVolume(readWith(percent)), whole * percent / 100, 1e-6 * whole * percent / 100) << percent;
}

TEST(FlowPercent, ComesOnTopOfM221) {
    const double whole = beadVolume(readWith(100));
    EXPECT_NEAR(beadVolume(readWith(80, "M221 S50\n")), 0.4 * whole, 1e-6 * whole);
    // M221 S100 is what the file says, not what the option says.
    EXPECT_NEAR(beadVolume(readWith(80, "M221 S100\n")), 0.8 * whole, 1e-6 * whole);
}

TEST(FlowPercent, RefusesWhatNoPrinterCanBeSetTo) {
    for (const double percent : {0.0, -5.0, 1001.0, std::nan("")})
        EXPECT_THROW(readWith(percent), UsageError) << percent;
    EXPECT_NO_THROW(readWith(kMostFlow));
}

}  // namespace
}  // namespace stratum::gcode
