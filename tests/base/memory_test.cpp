#include "base/memory.h"

#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace stratum {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
}

TEST(Memory, OfTheSecondKindOfGroups) {
    const test::ScratchFolder top;
    write(top / "memory.stat", "anon 5\n");
    write(top / "a/memory.max", "1000\n");
    write(top / "a/memory.current", "700\n");
    write(top / "a/memory.stat", "anon 600\nfile 150\ninactive_file 100\nactive_file 50\n");
    write(top / "a/b/memory.max", "max\n");
    write(top / "a/b/memory.current", "10\n");
    EXPECT_EQ(freeInGroups(top.path(), "0::/a/b\n"), 400U);  // of the group above, less what can be dropped
    EXPECT_EQ(freeInGroups(top.path(), "0::/\n"), std::nullopt);
    EXPECT_EQ(freeInGroups(top.path(), "0::/elsewhere\n"), std::nullopt);
    write(top / "memory.max", "300");
    EXPECT_EQ(freeInGroups(top.path(), "0::/elsewhere\n"), 300U);
    write(top / "a/memory.current", "2000");
    EXPECT_EQ(freeInGroups(top.path(), "0::/a/b\n"), 0U);
}

TEST(Memory, OfTheFirstKindOfGroups) {
    const test::ScratchFolder top;
    const std::string membership = "12:pids:/x\n7:cpu,memory:/box\n0::/\n";
    write(top / "memory/memory.limit_in_bytes", "9223372036854771712\n");
    EXPECT_EQ(freeInGroups(top.path(), membership), std::nullopt);
    write(top / "memory/box/memory.limit_in_bytes", "5000\n");
    write(top / "memory/box/memory.usage_in_bytes", "3000\n");
    write(top / "memory/box/memory.stat", "inactive_file 1\ntotal_inactive_file 500\n");
    EXPECT_EQ(freeInGroups(top.path(), membership), 2500U);
    EXPECT_EQ(freeInGroups(top.path(), "12:pids:/box\n"), std::nullopt);
    EXPECT_EQ(freeInGroups(top.path(), "no such thing"), std::nullopt);
}

TEST(Memory, OfALimitOnAddressSpace) {
    EXPECT_GT(availableMemory(), 0U);
    std::ifstream statm("/proc/self/statm");
    std::size_t pages = 0;
    statm >> pages;
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
    rlimit low = before;
    constexpr std::size_t kLeft = std::size_t{50} << 20;
    low.rlim_cur = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + kLeft;
    if (before.rlim_max != RLIM_INFINITY && low.rlim_cur > before.rlim_max) GTEST_SKIP() << "there is a lower limit";
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer maps terabytes";
#endif
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &low), 0);
    rlimit now{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &now), 0);
    if (now.rlim_cur != low.rlim_cur) GTEST_SKIP() << "an emulator of another processor keeps its own limit";
    const std::size_t free = availableMemory();
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_LE(free, kLeft);
    EXPECT_GT(free, 0U);
}

}  // namespace
}  // namespace stratum
