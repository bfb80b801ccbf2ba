#include "base/names.h"

#include <gtest/gtest.h>

#include <array>

namespace stratum {
namespace {

constexpr std::array<std::string_view, 4> kNames{"studio", "sky", "constant", "a"};

TEST(NearestName, FindsWhatWasMeant) {
    EXPECT_EQ(nearestName("studo", kNames), "studio");
    EXPECT_EQ(nearestName("skies", kNames), "");
    EXPECT_EQ(nearestName("skx", kNames), "sky");
    EXPECT_EQ(nearestName("constnat", kNames), "constant");
    EXPECT_EQ(nearestName("disco", kNames), "");
    EXPECT_EQ(nearestName("", kNames), "");
    EXPECT_EQ(nearestName("b", kNames), "");
    EXPECT_EQ(nearestName(std::string(100000, 's'), kNames), "");
}

TEST(NearestName, EndsMessages) {
    EXPECT_EQ(didYouMean("stuido", kNames), "; did you mean 'studio'?");
    EXPECT_EQ(didYouMean("disco", {"paper", "pei"}), "");
}

}  // namespace
}  // namespace stratum
