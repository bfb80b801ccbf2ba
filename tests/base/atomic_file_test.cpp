#include "base/atomic_file.h"

#include "base/checksum.h"
#include "base/error.h"
#include "scratch_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

namespace stratum {
namespace {

std::size_t filesIn(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

class EachMaking : public testing::TestWithParam<AtomicFile::Making> {};
INSTANTIATE_TEST_SUITE_P(AtomicFile, EachMaking,
                         testing::Values(AtomicFile::Making::unnamed, AtomicFile::Making::named));

TEST_P(EachMaking, CommitReplacesAndLeavesNothingBeside) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    {
        AtomicFile file(folder / "out", GetParam());
        std::ofstream(file.temporary()) << "new";
        EXPECT_EQ(test::bytesOf(folder / "out"), "old");
        file.commit();
    }
    EXPECT_EQ(test::bytesOf(folder / "out"), "new");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

// The part's own name is cut; what killed runs left is found all the same, and names that differ at their ends alone
// have parts of their own.
TEST_P(EachMaking, NamesOf255BytesCanBeWritten) {
    const test::ScratchFolder folder;
    const std::string name(255, 'n');
    const std::string other = name.substr(1) + "o";
    std::ofstream(folder / fmt::format(".{}.{:08x}.99999.part", name.substr(0, 220), checksumOf(name))) << "left";
    AtomicFile file(folder / name, GetParam());
    AtomicFile second(folder / other, GetParam());
    std::ofstream(file.temporary()) << "new";
    std::ofstream(second.temporary()) << "another";
    file.commit();
    second.commit();
    EXPECT_EQ(test::bytesOf(folder / name), "new");
    EXPECT_EQ(test::bytesOf(folder / other), "another");
    EXPECT_EQ(filesIn(folder.path()), 2U);
}

TEST_P(EachMaking, ModesAreThoseOfAnyNewFile) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "plain") << "x";
    AtomicFile file(folder / "out", GetParam());
    file.commit();
    EXPECT_EQ(std::filesystem::status(folder / "out").permissions(),
              std::filesystem::status(folder / "plain").permissions());
}

TEST_P(EachMaking, TwoAtOnceTheLastOneStays) {
    const test::ScratchFolder folder;
    AtomicFile first(folder / "out", GetParam());
    std::ofstream(first.temporary()) << "first";
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        AtomicFile second(folder / "out", GetParam());
        std::ofstream(second.temporary()) << "second";
        second.commit();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(test::bytesOf(folder / "out"), "second");
    first.commit();
    EXPECT_EQ(test::bytesOf(folder / "out"), "first");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST_P(EachMaking, AKilledRunLeavesNothingThatTheNextOneKeeps) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const AtomicFile file(folder / "out", GetParam());
        std::ofstream(file.temporary()) << "half";
        ::raise(SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(test::bytesOf(folder / "out"), "old");
    if (GetParam() == AtomicFile::Making::named) {
        EXPECT_EQ(filesIn(folder.path()), 2U);
    }
    // Of its own file and others', the next run removes what nobody holds.
    std::ofstream(folder / ".other.123.part") << "of another output";
    std::ofstream(folder / ".out.mine.part") << "of somebody else";
    { const AtomicFile next(folder / "out", GetParam()); }
    EXPECT_EQ(filesIn(folder.path()), 3U);
    EXPECT_EQ(test::bytesOf(folder / "out"), "old");
}

TEST(AtomicFile, WhatARunHoldsStays) {
    const test::ScratchFolder folder;
    const int held = ::open((folder / ".out.1.part").c_str(), O_RDWR | O_CREAT, 0666);
    ASSERT_EQ(::flock(held, LOCK_EX), 0);
    std::ofstream(folder / ".out.2.part") << "left";
    { const AtomicFile file(folder / "out"); }
    EXPECT_TRUE(std::filesystem::exists(folder / ".out.1.part"));
    EXPECT_FALSE(std::filesystem::exists(folder / ".out.2.part"));
    ::close(held);
}

TEST_P(EachMaking, WithoutCommitTheOldFileStays) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    {
        const AtomicFile file(folder / "out", GetParam());
        std::ofstream(file.temporary()) << "half";
    }
    EXPECT_EQ(test::bytesOf(folder / "out"), "old");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST_P(EachMaking, WritersFailInTheDestinationsName) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    const std::string out = (folder / "out").string();
    try {
        AtomicFile(out, GetParam()).write([](const std::filesystem::path& to) {
            throw OutputError(to.string() + ": full; mend " + to.string());
        });
        ADD_FAILURE() << "nothing was thrown";
    } catch (const OutputError& error) {
        EXPECT_EQ(error.what(), out + ": full; mend " + out);
    }
    EXPECT_EQ(test::bytesOf(folder / "out"), "old");
    AtomicFile(out, GetParam()).write([](const std::filesystem::path& to) { std::ofstream(to) << "new"; });
    EXPECT_EQ(test::bytesOf(folder / "out"), "new");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST_P(EachMaking, ALinkStaysAndItsFileIsReplaced) {
    const test::ScratchFolder folder;
    std::filesystem::create_directory(folder / "elsewhere");
    test::writeText(folder / "elsewhere/file", "old");
    std::filesystem::create_symlink("elsewhere/file", folder / "link");
    std::filesystem::create_symlink(folder / "link", folder / "second");
    std::filesystem::create_symlink("elsewhere/new", folder / "dangling");
    for (const char* name : {"link", "second", "dangling"}) {
        AtomicFile file(folder / name, GetParam());
        test::writeText(file.temporary(), name);
        file.commit();
        EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
        EXPECT_EQ(test::bytesOf(folder / name), name);
    }
    EXPECT_EQ(test::bytesOf(folder / "elsewhere/file"), "second");
    EXPECT_EQ(test::bytesOf(folder / "elsewhere/new"), "dangling");
    EXPECT_EQ(filesIn(folder / "elsewhere"), 2U);
    std::filesystem::create_symlink("round", folder / "round");
    EXPECT_THROW(AtomicFile(folder / "round", GetParam()), OutputError);
}

class Guarded : public testing::Test {
protected:
    Guarded() { Replacement::guard(true); }
    ~Guarded() override { Replacement::guard(false); }
    const test::ScratchFolder folder_;
};

TEST_F(Guarded, AFileOfSomebodyElseIsNotReplaced) {
    test::writeText(folder_ / "theirs", "solid by hand");
    test::writeText(folder_ / "ours", "binary STL by Stratum 1.0");
    test::writeText(folder_ / "empty", "");
    std::filesystem::create_symlink("theirs", folder_ / "link");
    EXPECT_THROW(AtomicFile(folder_ / "theirs"), UsageError);
    EXPECT_THROW(AtomicFile(folder_ / "link"), UsageError);
    EXPECT_THROW(AtomicFile::probe(folder_ / "theirs"), UsageError);
    EXPECT_THROW(Replacement::check(folder_ / "theirs"), UsageError);
    for (const char* name : {"ours", "empty", "new"}) EXPECT_NO_THROW(AtomicFile(folder_ / name)) << name;
    EXPECT_EQ(test::bytesOf(folder_ / "theirs"), "solid by hand");
    try {
        AtomicFile(folder_ / "theirs");
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("--force"), std::string::npos) << error.what();
    }
}

TEST_F(Guarded, UnlessThatIsAllowed) {
    test::writeText(folder_ / "theirs", "solid by hand");
    {
        const Replacement no(folder_ / "theirs", false);
        EXPECT_THROW(AtomicFile(folder_ / "theirs"), UsageError);
        const Replacement may(folder_ / "theirs");
        EXPECT_NO_THROW(AtomicFile(folder_ / "theirs"));
    }
    EXPECT_THROW(AtomicFile(folder_ / "theirs"), UsageError);
    Replacement::guard(false);
    EXPECT_NO_THROW(AtomicFile(folder_ / "theirs"));
}

TEST(AtomicFile, AProbeOpensNoPipe) {
    const test::ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    AtomicFile::probe(folder / "pipe");  // would wait for a reader
    EXPECT_THROW(AtomicFile::probe(folder / "none/file"), OutputError);
}

TEST(AtomicFile, RefusesBeforeTheWork) {
    EXPECT_THROW(AtomicFile("/nonexistent/folder/out.vdb"), OutputError);
    const test::ScratchFolder folder;
    EXPECT_THROW(AtomicFile{folder.path()}, OutputError);
}

// What stands there and is no file stays what it is, and gets the bytes.
TEST(AtomicFile, PoursIntoStreams) {
    const test::ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
    {
        AtomicFile file(folder / "pipe");
        std::ofstream(file.temporary()) << "whole";
        std::array<char, 16> buffer{};
        EXPECT_LE(::read(reader, buffer.data(), buffer.size()), 0) << "nothing before the commit";
        file.commit();
        EXPECT_EQ(::read(reader, buffer.data(), buffer.size()), 5);
        EXPECT_STREQ(buffer.data(), "whole");
    }
    ::close(reader);
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(AtomicFile, AFullDeviceIsAnError) {
    AtomicFile file("/dev/full");
    std::ofstream(file.temporary()) << "much";
    EXPECT_THROW(file.commit(), OutputError);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

// The most memory that this process has had since it was set back; kilobytes.
std::size_t peakKilobytes(bool set_back) {
    if (set_back) std::ofstream("/proc/self/clear_refs") << 5;
    std::ifstream facts("/proc/self/status");
    for (std::string line; std::getline(facts, line);)
        if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6));
    return 0;
}

TEST(WriteFile, HoldsNoSecondCopyOfLargeBytes) {
    const test::ScratchFolder folder;
    std::string bytes(std::size_t{64} << 20, 'a');
    bytes.back() = 'z';
    [[maybe_unused]] const std::size_t before = peakKilobytes(true);
    writeFile(folder / "out", bytes);
#ifndef STRATUM_SANITIZED  // which keeps what is freed
    EXPECT_LT(peakKilobytes(false) - before, std::size_t{32} << 10);
#endif
    EXPECT_EQ(test::bytesOf(folder / "out"), bytes);
    writeFile(folder / "empty", "");
    EXPECT_EQ(std::filesystem::file_size(folder / "empty"), 0U);
}

TEST(AtomicFile, ADashIsStandardOutput) {
    EXPECT_TRUE(isStandardOutput("-"));
    EXPECT_TRUE(isStandardOutput("-.exr"));
    EXPECT_FALSE(isStandardOutput("./-"));
    EXPECT_FALSE(isStandardOutput("-.d/a"));
    EXPECT_FALSE(isStandardOutput("a-"));
    EXPECT_FALSE(isStandardOutput(""));
}

TEST_P(EachMaking, ASignalRemovesTheTemporary) {
    const test::ScratchFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        AtomicFile::removeOnSignals();
        const AtomicFile file(folder / "out", GetParam());
        ::raise(SIGTERM);
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    EXPECT_EQ(filesIn(folder.path()), 0U);
}

}  // namespace
}  // namespace stratum
