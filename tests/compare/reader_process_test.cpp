#include "compare/reader_process.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

namespace stratum::compare {
namespace {

std::string refusalOf(const std::function<std::string()>& read) {
    try {
        (void)readInProcess("a.3mf", read);
    } catch (const InputError& error) {
        return error.what();
    }
    return "was read";
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
