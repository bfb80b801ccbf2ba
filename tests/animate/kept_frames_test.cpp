#include "animate/kept_frames.h"

#include "base/atomic_file.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace stratum::animate {
namespace {

const std::string kScene = "0123456789abcdef0123456789abcdef";
const std::string kOther = "fedcba98765432100123456789abcdef";

std::vector<std::uint8_t> picture(int seed) {
    std::vector<std::uint8_t> rgb;
    for (int n = 0; n < 3 * 8 * 6; ++n) rgb.push_back(static_cast<std::uint8_t>(n * seed + n / 7));
    return rgb;
}

TEST(KeptFrames, ReturnsWhatItGot) {
    const test::ScratchFolder folder;
    const KeptFrames frames(folder / "film.mp4.frames", kScene, 8, 6);
    EXPECT_FALSE(frames.has(0));
    EXPECT_TRUE(folder.empty());  // nothing is made before the first frame
    frames.keep(0, picture(3));
    frames.keep(1234567, picture(5));
    EXPECT_EQ(frames.read(0), picture(3));
    EXPECT_EQ(frames.read(1234567), picture(5));
    EXPECT_FALSE(frames.read(1));
    frames.remove();
    EXPECT_TRUE(folder.empty());
}

TEST(KeptFrames, TakesNoFrameOfAnotherScene) {
    const test::ScratchFolder folder;
    const KeptFrames before(folder / "f", kOther, 8, 6);
    before.keep(0, picture(3));
    const KeptFrames frames(folder / "f", kScene, 8, 6);
    EXPECT_FALSE(frames.has(0));
    frames.keep(0, picture(5));
    EXPECT_EQ(before.read(0), picture(3));
    EXPECT_EQ(frames.read(0), picture(5));
    // Those of both are removed, another file is not.
    std::ofstream(folder / "f/notes.txt") << "mine";
    frames.remove();
    EXPECT_FALSE(before.has(0));
    EXPECT_TRUE(std::filesystem::exists(folder / "f/notes.txt"));
}

TEST(KeptFrames, DamagedFramesAreMissing) {
    const test::ScratchFolder folder;
    const KeptFrames frames(folder / "f", kScene, 8, 6);
    frames.keep(0, picture(3));
    EXPECT_FALSE(KeptFrames(folder / "f", kScene, 6, 8).read(0));
    const std::filesystem::path file = std::filesystem::directory_iterator(folder / "f")->path();
    const auto size = std::filesystem::file_size(file);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(static_cast<std::streamoff>(size / 2))
        << '\xff' << '\x01';
    EXPECT_FALSE(frames.read(0));
    frames.keep(0, picture(3));
    EXPECT_TRUE(frames.read(0));
    std::filesystem::resize_file(file, size / 2);
    EXPECT_FALSE(frames.read(0));
    std::filesystem::resize_file(file, 0);
    EXPECT_FALSE(frames.read(0));
    // It is replaced, though nothing says any more whose it was.
    std::ofstream(file) << "damaged";
    Replacement::guard(true);
    EXPECT_NO_THROW(frames.keep(0, picture(3)));
    Replacement::guard(false);
    EXPECT_TRUE(frames.read(0));
}

}  // namespace
}  // namespace stratum::animate
