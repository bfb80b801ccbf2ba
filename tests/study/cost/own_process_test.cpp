#include "study/cost/own_process.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace stratum::study {
namespace {

TEST(OwnProcess, ReturnsWhatTheWorkReturns) {
    const pid_t own = ::getpid();
    const std::string large(1000000, 'x');
    const Outcome outcome = inOwnProcess([&] { return large + (::getpid() == own ? "same" : "other"); });
    EXPECT_EQ(outcome.failure, "");
    EXPECT_EQ(outcome.text, large + "other");
}

TEST(OwnProcess, CountsTheMemoryOfTheWorkAlone) {
    constexpr std::size_t kBytes = std::size_t{200} << 20;
    const auto touch = [](std::size_t bytes) {
        std::vector<char> memory(bytes);
        // Volatile: a compiler may leave out memory whose contents it knows.
        volatile char* const byte = memory.data();
        for (std::size_t n = 0; n < bytes; ++n) byte[n] = 1;
        return std::string("done");
    };
    const std::size_t large = inOwnProcess([&] { return touch(kBytes); }).peak_rss_bytes;
    const std::size_t small = inOwnProcess([&] { return touch(1000); }).peak_rss_bytes;
    EXPECT_GT(large, kBytes);
    EXPECT_LT(small, kBytes / 2);
}

std::size_t threads() {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) count += entry.exists() ? 1 : 0;
    return count;
}

// Two parts that wait for each other: done only by two threads.
void workOnTwo() {
    const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
    std::atomic<int> arrived{0};
    tbb::parallel_for(
        0, 2,
        [&](int) {
            ++arrived;
            for (int wait = 0; wait < 20000 && arrived < 2; ++wait) ::usleep(100);
        },
        tbb::simple_partitioner());
    EXPECT_EQ(arrived, 2);
}

TEST(OwnProcess, BeginsWithoutOtherThreads) {
    workOnTwo();
    const std::size_t before = threads();
    ASSERT_GT(before, 1U);
    const Outcome outcome = inOwnProcess([] {
        const std::size_t at_first = threads();
        workOnTwo();
        return std::to_string(at_first) + (threads() > at_first ? " then more" : " and no more");
    });
    EXPECT_EQ(outcome.failure, "");
    EXPECT_EQ(outcome.text, "1 then more");
    EXPECT_LT(threads(), before);
    workOnTwo();
}

TEST(OwnProcess, SaysHowItEnded) {
    EXPECT_EQ(inOwnProcess([]() -> std::string { throw std::runtime_error("no luck"); }).failure, "no luck");
    EXPECT_EQ(inOwnProcess([]() -> std::string {
                  ::signal(SIGTERM, SIG_DFL);
                  ::raise(SIGTERM);
                  return "";
              }).failure,
              "ended by signal 15");
    EXPECT_EQ(inOwnProcess([]() -> std::string { ::_exit(0); }).failure, "ended without a word");
    const Outcome slow = inOwnProcess(
        [] {
            ::sleep(30);
            return std::string();
        },
        0.2);
    EXPECT_EQ(slow.failure, "took longer than 0.2 s");
}

TEST(OwnProcess, RowsComeBackAsTheyWere) {
    EXPECT_EQ(rowInOwnProcess("print", 1, [] { return Row{"a,b", "", "3"}; }), (Row{"a,b", "", "3"}));
    try {
        rowInOwnProcess("print", 1, []() -> Row { throw std::runtime_error("no luck"); });
        FAIL() << "a failure was lost";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "print: no luck");
    }
}

}  // namespace
}  // namespace stratum::study
