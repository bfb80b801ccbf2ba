#include "shade/parts/frame_record.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace stratum {
namespace {

void fill(const std::filesystem::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

TEST(FrameRecord, HasWhatWasFinishedAndDidNotChange) {
    const test::ScratchFolder folder;
    fill(folder / "a 1.png", "one");
    fill(folder / "b.png", "two");
    shade::FrameRecord(folder / "f.done").add(folder / "a 1.png", "s");
    shade::FrameRecord(folder / "f.done").add(folder / "b.png", "t");
    const shade::FrameRecord record(folder / "f.done");
    EXPECT_TRUE(record.has(folder / "a 1.png", "s"));
    EXPECT_TRUE(record.has(folder / "b.png", "t"));
    EXPECT_FALSE(record.has(folder / "a 1.png", "t"));
    EXPECT_FALSE(record.has(folder / "c.png", "s"));
    fill(folder / "b.png", "twin");
    EXPECT_FALSE(record.has(folder / "b.png", "t"));
    std::filesystem::remove(folder / "a 1.png");
    EXPECT_FALSE(record.has(folder / "a 1.png", "s"));
}

TEST(FrameRecord, DamagedLinesCountAsMissing) {
    const test::ScratchFolder folder;
    fill(folder / "a.png", "one");
    for (const char* text : {"", "\n", "s", "s \n", "  \n", "s  a.png\n", "s 00 a.png"}) {
        fill(folder / "f.done", text);
        EXPECT_FALSE(shade::FrameRecord(folder / "f.done").has(folder / "a.png", "s")) << text;
    }
    EXPECT_THROW(shade::FrameRecord(folder / "none/f.done").add(folder / "a.png", "s"), OutputError);
}

}  // namespace
}  // namespace stratum
