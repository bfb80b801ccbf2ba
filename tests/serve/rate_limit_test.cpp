#include "serve/socket_client.h"

#include <gtest/gtest.h>

namespace stratum::serve {
namespace {

TEST(RateLimit, ABurstAndThenTheMean) {
    RateLimit limit(10);
    const auto start = RateLimit::Clock::now();
    int taken = 0;
    for (int n = 0; n < 100; ++n) taken += limit.take(start) ? 1 : 0;
    EXPECT_EQ(taken, 20);
    for (int n = 1; n <= 1000; ++n) taken += limit.take(start + std::chrono::milliseconds(10 * n)) ? 1 : 0;
    EXPECT_NEAR(taken, 20 + 100, 1);
}

}  // namespace
}  // namespace stratum::serve
