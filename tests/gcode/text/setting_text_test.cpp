#include "gcode/text/setting_text.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

using Parts = std::vector<std::string_view>;

TEST(SettingText, TakesAPrefix) {
    std::string_view text = "Filament: \"PLA\"\r";
    EXPECT_FALSE(takePrefix(text, "filament:"));
    EXPECT_TRUE(takePrefix(text, "Filament:"));
    EXPECT_EQ(text, "PLA");
}

TEST(SettingText, DividesKeyAndValue) {
    const auto setting = keyAndValue("nozzle_diameter = \"0.4\" ");
    ASSERT_TRUE(setting);
    EXPECT_EQ(setting->first, "nozzle_diameter");
    EXPECT_EQ(setting->second, "0.4");
    EXPECT_FALSE(keyAndValue("a=b"));
}

TEST(SettingText, DividesLists) {
    EXPECT_EQ(partsOf("a, \"b\";c", ",;"), (Parts{"a", "b", "c"}));
    EXPECT_EQ(partsOf("a,,b,", ","), (Parts{"a", "", "b"}));
    EXPECT_TRUE(partsOf("", ",").empty());
    EXPECT_EQ(partsOf(std::string(1000, ','), ",").size(), kMostParts);
}

TEST(SettingText, ReadsNumbers) {
    EXPECT_EQ(numbersOf("1, 2mm,3", 0, 3), (std::vector<double>{1, 2, 3}));
    EXPECT_TRUE(numbersOf("1,4", 0, 3).empty());
    EXPECT_TRUE(numbersOf("1,x", 0, 3).empty());
    EXPECT_EQ(positiveNumber(" 0.4 mm", 100), 0.4);
    EXPECT_FALSE(positiveNumber("0", 100));
    EXPECT_FALSE(positiveNumber("101", 100));
}

}  // namespace
}  // namespace stratum::gcode
