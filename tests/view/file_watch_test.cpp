#include "view/file_watch.h"

#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <poll.h>

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

TEST(FileWatch, LeavesOutFoldersThatAreNotThere) {
    FileWatch watch({"/nowhere/part.gcode"});
    EXPECT_TRUE(watch.changed().empty());
}

}  // namespace
}  // namespace stratum::view
