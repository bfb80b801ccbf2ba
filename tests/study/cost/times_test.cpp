#include "study/cost/times.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace stratum::study {
namespace {

TEST(Times, WallTimePassesWhileNobodyWorks) {
    const Times times = timesOf([] { std::this_thread::sleep_for(std::chrono::milliseconds(60)); });
    EXPECT_GE(times.wall, 0.06);
    EXPECT_LT(times.cpu, 0.05);
}

TEST(Median, IsTheUpperOfTwoMiddleValues) {
    EXPECT_EQ(median({3, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 3, 2}), 3);
}

}  // namespace
}  // namespace stratum::study
