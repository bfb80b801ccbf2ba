#include "animate/encode/ffmpeg_writer.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace stratum::animate {
namespace {

std::filesystem::path shell() { return findProgram("sh").value(); }

TEST(ChildProcess, GetsAllThatIsSent) {
    const test::ScratchFolder folder;
    const std::vector<std::uint8_t> bytes(1 << 20, 'x');
    ChildProcess child(shell(), {"-c", "cat > '" + (folder / "got").string() + "'"});
    EXPECT_TRUE(child.send(bytes));
    EXPECT_TRUE(child.send(bytes));
    EXPECT_EQ(child.finish(), "");
    EXPECT_EQ(std::filesystem::file_size(folder / "got"), 2 * bytes.size());
}

TEST(ChildProcess, SaysHowItEnded) {
    ChildProcess failing(shell(), {"-c", "echo first >&2; echo 'the last line' >&2; exit 3"});
    EXPECT_EQ(failing.finish(), "ended with status 3");
    EXPECT_EQ(failing.lastWords(), "the last line");
    ChildProcess killed(shell(), {"-c", "kill -9 $$"});
    EXPECT_EQ(killed.finish(), "was ended by signal 9");
    EXPECT_EQ(killed.lastWords(), "");
}

TEST(ChildProcess, OneThatReadsNoMoreIsNoSignal) {
    ChildProcess child(shell(), {"-c", "head -c 10 > /dev/null; echo enough >&2"});
    const std::vector<std::uint8_t> bytes(1 << 20, 'x');
    bool taken = true;
    for (int n = 0; n < 100 && taken; ++n) taken = child.send(bytes);
    EXPECT_FALSE(taken);
    EXPECT_EQ(child.finish(), "");
    EXPECT_EQ(child.lastWords(), "enough");
}

TEST(ChildProcess, DoesNotOutliveItsOwner) {
    const test::ScratchFolder folder;
    const std::filesystem::path id = folder / "id";
    {
        ChildProcess child(shell(), {"-c", "echo $$ > '" + id.string() + "'; exec sleep 100"});
        while (!std::filesystem::exists(id) || std::filesystem::file_size(id) == 0) continue;
    }
    std::string number;
    std::ifstream(id) >> number;
    EXPECT_FALSE(std::filesystem::exists("/proc/" + number));
}

TEST(ChildProcess, ProgramsAreFoundOnThePath) {
    EXPECT_TRUE(findProgram("sh"));
    EXPECT_FALSE(findProgram("no-program-has-this-name"));
    EXPECT_THROW(ChildProcess("/no-program-has-this-name", {}), OutputError);
}

}  // namespace
}  // namespace stratum::animate
