#include "gcode/machine/limit_origins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace stratum::gcode {
namespace {

TEST(LimitOrigins, EveryLimitIsAMemberOfItsOwn) {
    MachineLimits limits;
    std::set<const double*> members;
    for (std::size_t n = 0; n < kLimitCount; ++n) {
        const auto limit = static_cast<Limit>(n);
        members.insert(&valueOf(limits, limit));
        const Bounds bounds = boundsOf(limit);
        EXPECT_LT(bounds.least, bounds.most);
        // The defaults are limits that one may state; steps are unknown.
        const double value = valueOf(limits, limit);
        if (std::isfinite(value) && value != 0) EXPECT_TRUE(value >= bounds.least && value <= bounds.most) << n;
        EXPECT_FALSE(limitName(limit, CornerRule::jerk).empty());
    }
    EXPECT_EQ(members.size(), kLimitCount);
    EXPECT_EQ(&valueOf(limits, ofAxis(Limit::jerk, 3)), &limits.jerk[3]);
    EXPECT_EQ(&valueOf(limits, ofAxis(Limit::steps_per_mm, 1)), &limits.steps_per_mm[1]);
}

TEST(LimitOrigins, EachRuleReadsItsOwn) {
    EXPECT_TRUE(isUsed(Limit::cruise_ratio, CornerRule::corner_velocity));
    EXPECT_FALSE(isUsed(Limit::cruise_ratio, CornerRule::jerk));
    EXPECT_FALSE(isUsed(Limit::jerk, CornerRule::corner_velocity));
    EXPECT_FALSE(isUsed(Limit::speed, CornerRule::corner_velocity));
    EXPECT_TRUE(isUsed(ofAxis(Limit::speed, 2), CornerRule::corner_velocity));
    EXPECT_TRUE(isUsed(Limit::junction_deviation, CornerRule::junction_deviation));
    EXPECT_FALSE(isUsed(Limit::jerk, CornerRule::junction_deviation));
    EXPECT_EQ(limitName(Limit::printing, CornerRule::corner_velocity), "max_accel");
    EXPECT_EQ(limitName(Limit::printing, CornerRule::jerk), "acceleration of printing");
}

}  // namespace
}  // namespace stratum::gcode
