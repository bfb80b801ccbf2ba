#include "view/file_watch.h"

#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace stratum::view {
namespace {

std::set<std::string> changesOf(FileWatch& watch) {
    pollfd poll{watch.descriptor(), POLLIN, 0};
    (void)::poll(&poll, 1, 2000);
    return watch.changed();
}

TEST(FileWatch, TellsOfWritingAndOfRenaming) {
    const test::ScratchFolder folder;
    const std::string path = (folder / "part.gcode").string();
    std::ofstream(path) << "one";
    FileWatch watch({path});
    ASSERT_GE(watch.descriptor(), 0);
    EXPECT_TRUE(watch.changed().empty());
    std::ofstream(path) << "two";
    EXPECT_EQ(changesOf(watch), std::set<std::string>{path});
    std::ofstream(folder / "part.new") << "three";
    EXPECT_TRUE(changesOf(watch).empty());  // another file
    std::filesystem::rename(folder / "part.new", path);
    EXPECT_EQ(changesOf(watch), std::set<std::string>{path});
}

TEST(FileWatch, FollowsLinksAndOtherNames) {
    const test::ScratchFolder folder;
    const std::string link = (folder / "link.gcode").string();
    std::filesystem::create_directory(folder / "out");
    std::ofstream(folder / "out/part.gcode") << "one";
    std::filesystem::create_symlink("out/part.gcode", link);
    std::filesystem::create_hard_link(folder / "out/part.gcode", folder / "out/other.gcode");
    FileWatch watch({link});
    std::ofstream(folder / "out/part.gcode") << "two";
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
    std::ofstream(folder / "out/other.gcode", std::ios::app) << "two";
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
    // The target gets another file, and the link another target.
    std::ofstream(folder / "new") << "three";
    std::filesystem::rename(folder / "new", folder / "out/part.gcode");
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
    std::ofstream(folder / "third.gcode") << "four";
    std::filesystem::create_symlink("third.gcode", folder / "new_link");
    (void)watch.changed();
    std::filesystem::rename(folder / "new_link", link);
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
    std::ofstream(folder / "third.gcode") << "five";
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
}

// Neither is ever written and closed.
TEST(FileWatch, TellsOfAPipe) {
    const test::ScratchFolder folder;
    const std::string link = (folder / "link.gcode").string();
    const std::string pipe = (folder / "pipe").string();
    std::ofstream(folder / "part.gcode") << "one";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::create_symlink("part.gcode", link);
    FileWatch watch({link});
    std::filesystem::remove(link);
    (void)watch.changed();
    std::filesystem::create_symlink("pipe", link);
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
    std::filesystem::remove(link);
    (void)watch.changed();
    ASSERT_EQ(mkfifo(link.c_str(), 0600), 0);
    EXPECT_EQ(changesOf(watch), std::set<std::string>{link});
}

TEST(FileWatch, WaitsForFolders) {
    const test::ScratchFolder folder;
    const std::string path = (folder / "later/deep/part.gcode").string();
    FileWatch watch({path});
    EXPECT_TRUE(watch.changed().empty());
    std::filesystem::create_directory(folder / "later");
    EXPECT_TRUE(changesOf(watch).empty());
    std::filesystem::create_directory(folder / "later/deep");
    EXPECT_TRUE(changesOf(watch).empty());
    std::ofstream(path) << "one";
    EXPECT_EQ(changesOf(watch), std::set<std::string>{path});
}

}  // namespace
}  // namespace stratum::view
