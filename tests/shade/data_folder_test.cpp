#include "shade/data_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace stratum::shade {
namespace {

TEST(DataFolder, IsTheSourcesOfABuild) {
    ASSERT_EQ(std::getenv("STRATUM_DATA"), nullptr);
    EXPECT_TRUE(std::filesystem::exists(dataFolder() / "filaments" / "colors.tsv"));
    EXPECT_TRUE(std::filesystem::exists(dataFolder() / "brdf"));
}

TEST(DataFolder, TheEnvironmentGoesFirst) {
    ::setenv("STRATUM_DATA", "/somewhere/else", 1);
    const std::filesystem::path said = dataFolder();
    ::unsetenv("STRATUM_DATA");
    EXPECT_EQ(said, "/somewhere/else");
}

}  // namespace
}  // namespace stratum::shade
