#include "io/atomic_file.h"

#include "io/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

namespace stratum {
namespace {

std::string slurp(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

std::size_t filesIn(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, CommitReplacesAndLeavesNothingBeside) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    AtomicFile file(folder / "out");
    std::ofstream(file.temporary()) << "new";
    EXPECT_EQ(slurp(folder / "out"), "old");
    file.commit();
    EXPECT_EQ(slurp(folder / "out"), "new");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(AtomicFile, WithoutCommitTheOldFileStays) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "out") << "old";
    {
        const AtomicFile file(folder / "out");
        std::ofstream(file.temporary()) << "half";
    }
    EXPECT_EQ(slurp(folder / "out"), "old");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(AtomicFile, RefusesBeforeTheWork) {
    EXPECT_THROW(AtomicFile("/nonexistent/folder/out.vdb"), OutputError);
    const test::ScratchFolder folder;
    EXPECT_THROW(AtomicFile{folder.path()}, OutputError);
}

TEST(AtomicFile, ASignalRemovesTheTemporary) {
    const test::ScratchFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        AtomicFile::removeOnSignals();
        const AtomicFile file(folder / "out");
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
