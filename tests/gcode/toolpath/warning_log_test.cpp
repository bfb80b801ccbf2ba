#include "gcode/toolpath/warning_log.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

TEST(WarningLog, CountsEqualTexts) {
    WarningLog log;
    log.add("a", 3);
    log.add("b", 4);
    log.add("a", 9);
    const auto warnings = log.take();
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_EQ(warnings[0].text, "a");
    EXPECT_EQ(warnings[0].first_line, 3U);
    EXPECT_EQ(warnings[0].count, 2U);
    EXPECT_EQ(warnings[1].text, "b");
    EXPECT_TRUE(log.take().empty());
}

TEST(WarningLog, DescribesAWarningInALine) {
    EXPECT_EQ(describe({"odd", 3, 1}, "a.gcode"), "a.gcode:3: odd");
    EXPECT_EQ(describe({"odd", 3, 2}, "a.gcode"), "a.gcode:3: odd (2 times)");
}

TEST(WarningLog, NoiseCantFillTheMemory) {
    WarningLog log;
    for (std::uint32_t i = 0; i < 100000; ++i) log.add(std::to_string(i), i);
    const auto warnings = log.take();
    EXPECT_EQ(warnings.size(), 101U);
    EXPECT_EQ(warnings.back().count, 100000U - 100U);
}

}  // namespace
}  // namespace stratum::gcode
