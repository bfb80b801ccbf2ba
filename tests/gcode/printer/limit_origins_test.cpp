#include "gcode/printer/limit_origins.h"

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
        if (std::isfinite(value) && value != 0) {
            EXPECT_TRUE(value >= bounds.least && value <= bounds.most) << n;
        }
        EXPECT_FALSE(limitName(limit, CornerRule::jerk).empty());
    }
    EXPECT_EQ(members.size(), kLimitCount);
    EXPECT_EQ(&valueOf(limits, ofAxis(Limit::jerk, 3)), &limits.jerk[3]);
    EXPECT_EQ(&valueOf(limits, ofAxis(Limit::steps_per_mm, 1)), &limits.steps_per_mm[1]);
}

TEST(LimitOrigins, EachRuleReadsItsOwn) {
    const auto reads = [](CornerRule rule, Limit limit) {
        LimitOrigins origins;
        origins.rule = rule;
        return isUsed(limit, origins);
    };
    EXPECT_TRUE(reads(CornerRule::corner_velocity, Limit::cruise_ratio));
    EXPECT_FALSE(reads(CornerRule::jerk, Limit::cruise_ratio));
    EXPECT_FALSE(reads(CornerRule::corner_velocity, Limit::jerk));
    EXPECT_FALSE(reads(CornerRule::corner_velocity, Limit::speed));
    EXPECT_TRUE(reads(CornerRule::corner_velocity, ofAxis(Limit::speed, 2)));
    EXPECT_TRUE(reads(CornerRule::junction_deviation, Limit::junction_deviation));
    EXPECT_FALSE(reads(CornerRule::junction_deviation, Limit::jerk));
    EXPECT_EQ(limitName(Limit::printing, CornerRule::corner_velocity), "max_accel");
    EXPECT_EQ(limitName(Limit::printing, CornerRule::jerk), "acceleration of printing");
}

}  // namespace
}  // namespace stratum::gcode
