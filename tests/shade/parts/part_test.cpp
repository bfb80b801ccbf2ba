#include "shade/parts/part.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/parts/merge.h"
#include "shade/parts/part_checks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace stratum {
namespace {

namespace fs = std::filesystem;

TEST(Part, IsThatOfItsSceneAndShardAlone) {
    const test::ScratchFolder folder;
    const fs::path path = test::writePartOf(folder, test::partOf(1, 3), test::wholeFilm());
    EXPECT_TRUE(shade::isPartOf(path, "1", "s", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "2", "s", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "t", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {0, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {1, 4}));
    EXPECT_FALSE(shade::isPartOf(folder / "none.exr", "1", "s", {1, 3}));
}

// Whatever is cut off or changed in a part: it is refused, or gives the same picture.
TEST(Part, DamageIsNeverMerged) {
    const test::ScratchFolder folder;
    const shade::Film film = test::wholeFilm();
    std::vector<fs::path> paths = {test::writePartOf(folder, test::partOf(0, 2), film),
                                   test::writePartOf(folder, test::partOf(1, 2), film)};
    (void)shade::mergeParts(folder / "good.exr", paths);
    const std::string good = test::bytesOf(paths[1]);
    const auto attempt = [&](const std::string& bytes, std::size_t at) {
        std::ofstream(folder / "bad.exr", std::ios::binary) << bytes;
        fs::remove(folder / "merged.exr");
        try {
            (void)shade::mergeParts(folder / "merged.exr", {paths[0], folder / "bad.exr"});
            EXPECT_TRUE(test::bytesOf(folder / "merged.exr") == test::bytesOf(folder / "good.exr")) << at;
        } catch (const InputError&) {
            EXPECT_FALSE(fs::exists(folder / "merged.exr")) << at;
        }
    };
    for (std::size_t at = 1; at < good.size(); at += 1 + at / 40) attempt(good.substr(0, at), at);
    for (std::size_t at = 0; at < good.size(); at += 1 + at / 200) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x21);
        attempt(bytes, at);
        bytes[at] = static_cast<char>(good[at] ^ 0x01);  // a digit becomes another
        attempt(bytes, at);
    }
}

}  // namespace
}  // namespace stratum
