#include "study/own_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
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
        std::vector<char> memory(bytes, 1);
        return std::string(1, static_cast<char>('a' + memory.back()));
    };
    const std::size_t large = inOwnProcess([&] { return touch(kBytes); }).peak_rss_bytes;
    const std::size_t small = inOwnProcess([&] { return touch(1000); }).peak_rss_bytes;
    EXPECT_GT(large, kBytes);
    EXPECT_LT(small, kBytes / 2);
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

}  // namespace
}  // namespace stratum::study
