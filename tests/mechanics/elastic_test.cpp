#include "mechanics/elastic.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace stratum::mechanics {
namespace {

TEST(Elastic, OneAndTwoNumbersAreIsotropic) {
    const Elastic one = parseElastic("3500");
    EXPECT_TRUE(one.isotropic);
    EXPECT_EQ(one.young[2], 3500);
    EXPECT_EQ(one.poisson[0], kDefaultPoisson);
    EXPECT_EQ(parseElastic("2000,0.4").poisson[1], 0.4);
    EXPECT_DOUBLE_EQ(parseElastic("2000,0.25").shear[1], 800);
}

TEST(Elastic, NineAreOrthotropic) {
    const Elastic e = parseElastic("3400,3000,2800,0.35,0.34,0.4,1200,1100,1000");
    EXPECT_FALSE(e.isotropic);
    EXPECT_EQ(e.young, (std::array<double, 3>{3400, 3000, 2800}));
    EXPECT_EQ(e.poisson, (std::array<double, 3>{0.35, 0.34, 0.4}));
    EXPECT_EQ(e.shear, (std::array<double, 3>{1200, 1100, 1000}));
}

TEST(Elastic, OthersAreRefused) {
    for (const char* text : {"", "x", "3500,", "3500,0.35,1", "1,2,3,4,5,6,7,8", "1,2,3,4,5,6,7,8,9,10", "-1", "0",
                             "nan", "inf", "3500,0.5", "3500,-1", "3500 ,0.3", "3500,0.6",
                             "1000,1000,1000,0.5,0.5,0.5,1,1,1", "1000,10,1000,0.3,0.3,11,500,500,500", "1e999"})
        EXPECT_THROW(parseElastic(text), UsageError) << text;
    // A small modulus along the second axis lets nu12 be large, not nu21.
    EXPECT_NO_THROW(parseElastic("1000,10,1000,3,0.3,0.003,500,500,500"));
}

}  // namespace
}  // namespace stratum::mechanics
