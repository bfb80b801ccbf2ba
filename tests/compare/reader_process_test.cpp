#include "compare/reader_process.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

namespace stratum::compare {
namespace {

std::string refusalOf(const std::function<std::string()>& read) {
    return test::messageOf<InputError>([&] { (void)readInProcess("a.3mf", read); }, "was read");
}

TEST(ReaderProcess, GivesTheBytes) {
    EXPECT_EQ(readInProcess("a.3mf", [] { return std::string(); }), "");
    const std::string much(3000000, 'x');
    EXPECT_TRUE(readInProcess("a.3mf", [&much] { return much; }) == much);
}

TEST(ReaderProcess, PassesOnWhatIsThrown) {
    EXPECT_EQ(refusalOf([]() -> std::string { throw InputError("a.3mf: is no model"); }), "a.3mf: is no model");
    EXPECT_NE(refusalOf([]() -> std::string {
                  throw std::runtime_error("odd");
              }).find("a.3mf: can't be read as a model (odd)"),
              std::string::npos);
}

TEST(ReaderProcess, ACrashEndsTheCopyAlone) {
    EXPECT_NE(refusalOf([]() -> std::string {
                  std::raise(SIGKILL);
                  return {};
              }).find("a.3mf"),
              std::string::npos);
    EXPECT_NE(refusalOf([]() -> std::string { std::abort(); }).find("crashed"), std::string::npos);
}

// An assertion's message empties the buffers: what the parent has not written yet must come out once, from the parent.
TEST(ReaderProcess, ACrashWritesNothingOfTheParents) {
    testing::internal::CaptureStdout();
    std::fputs("once", stdout);
    EXPECT_NE(refusalOf([]() -> std::string {
                  std::fflush(stdout);
                  std::abort();
              }).find("crashed"),
              std::string::npos);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "once");
}

volatile std::sig_atomic_t told_by_handler = -1;  // a file descriptor

TEST(ReaderProcess, ACrashRunsNoHandlerOfTheParents) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    told_by_handler = ends[1];
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) {
        auto* const before = std::signal(signal, [](int) {
            (void)!::write(told_by_handler, "x", 1);
            ::_exit(1);
        });
        EXPECT_NE(refusalOf([signal]() -> std::string {
                      std::raise(signal);
                      return {};
                  }).find("crashed"),
                  std::string::npos);
        (void)std::signal(signal, before);
    }
    ::close(ends[1]);
    char byte = 0;
    EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "a handler ran";
    ::close(ends[0]);
}

#ifndef STRATUM_SANITIZED
TEST(ReaderProcess, MemoryOfAFileIsBounded) {
    const std::string said = refusalOf([]() -> std::string {
        std::string much;
        for (int n = 0; n < 64; ++n) much.append(std::size_t{1} << 26, 'x');
        return "all of it";
    });
    EXPECT_NE(said.find("a.3mf: can't be read as a model"), std::string::npos) << said;
}
#endif

}  // namespace
}  // namespace stratum::compare
