#include "shade/brdf/preset.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::parsePreset;

TEST(ParsePreset, SplitsNameAndNumbers) {
    const shade::Preset p = parsePreset("name:1,-2.5,1e-3", "--x");
    EXPECT_EQ(p.name, "name");
    EXPECT_EQ(p.values, (std::vector<float>{1.0f, -2.5f, 1e-3f}));
    EXPECT_TRUE(parsePreset("studio", "--x").values.empty());
}

TEST(ParsePreset, NamesTheOptionAndTheWord) {
    try {
        parsePreset("a:1,two", "--brdf");
        FAIL();
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("--brdf"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("'two'"), std::string::npos);
    }
    for (const char* text : {"a:", "a:1,", "a:1,,2", "a: 1", "a:inf", "a:1e99", "a:1x"})
        EXPECT_THROW(parsePreset(text, "--x"), UsageError) << text;
}

}  // namespace
}  // namespace stratum
