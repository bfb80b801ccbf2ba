#include "base/parallel_for.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <stop_token>
#include <thread>
#include <vector>

namespace stratum {
namespace {

TEST(ParallelFor, CoversEveryItemOnce) {
    std::vector<std::atomic<int>> times(10007);
    parallelFor(times.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) ++times[n];
    });
    for (const std::atomic<int>& count : times) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, EndsWhenTheWorkIsAskedToStop) {
    std::stop_source source;
    const std::stop_token token = source.get_token();
    std::atomic<int> done{0};
    const auto work = [&] {
        parallelFor(1000, 1, [&](std::size_t, std::size_t) {
            // Loops within the loop belong to the same work.
            parallelFor(4, 1, [&](std::size_t, std::size_t) {
                if (++done == 100) source.request_stop();
            });
        });
    };
    {
        const StopScope scope(&token);
        EXPECT_THROW(work(), Stopped);
        EXPECT_THROW(stopIfAsked(), Stopped);
    }
    EXPECT_LT(done, 4000);
    EXPECT_NO_THROW(work());  // of this thread nobody asks that any more
    EXPECT_NO_THROW(stopIfAsked());
}

TEST(ParallelFor, WorksBesideEachOtherDoNotMind) {
    std::stop_source source;
    const std::stop_token token = source.get_token();
    source.request_stop();
    std::atomic<int> done{0};
    std::thread other([&] { parallelFor(5000, 1, [&](std::size_t, std::size_t) { ++done; }); });
    const StopScope scope(&token);
    for (int n = 0; n < 20; ++n) EXPECT_THROW(parallelFor(100, 1, [](std::size_t, std::size_t) {}), Stopped);
    other.join();
    EXPECT_EQ(done, 5000);
}

}  // namespace
}  // namespace stratum
