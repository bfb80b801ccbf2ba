#include "study/report/power_law.h"

#include <gtest/gtest.h>

#include <array>

namespace stratum::study {
namespace {

TEST(PowerLaw, FindsALawThatIsOne) {
    std::array<std::pair<double, double>, 3> points;
    for (std::size_t n = 0; n < 3; ++n) {
        const double x = 0.05 * static_cast<double>(n + 1);
        points[n] = {x, 7e3 * std::pow(x, -2.1)};
    }
    const PowerLaw law = fitPowerLaw(points);
    EXPECT_NEAR(law.exponent, -2.1, 1e-12);
    EXPECT_NEAR(law.factor, 7e3, 1e-7);
    EXPECT_LT(law.worst, 1e-12);
    EXPECT_NEAR(law.at(0.01), 7e3 * std::pow(0.01, -2.1), 1e-4);
}

TEST(PowerLaw, SaysHowFarOffItsPointsAre) {
    const std::array<std::pair<double, double>, 3> points{{{1, 1}, {2, 4}, {4, 8}}};
    const PowerLaw law = fitPowerLaw(points);
    EXPECT_NEAR(law.exponent, 1.5, 1e-12);  // by hand: slopes 2 and 1
    EXPECT_NEAR(law.worst, 1 - std::pow(2, -1.0 / 3), 1e-9);
}

TEST(PowerLaw, IsNoneForASingleSize) {
    const std::array<std::pair<double, double>, 2> points{{{1, 1}, {1, 4}}};
    EXPECT_TRUE(std::isnan(fitPowerLaw(points).exponent));
}

}  // namespace
}  // namespace stratum::study
