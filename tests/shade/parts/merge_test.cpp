#include "shade/parts/merge.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/parts/part_checks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace stratum {
namespace {

namespace fs = std::filesystem;

TEST(MergeParts, GivesTheBytesOfTheWholePicture) {
    const test::ScratchFolder folder;
    const shade::Film film = test::wholeFilm();
    shade::PictureFile(folder / "whole.exr").write(film, {{"Software", "test"}, {shade::kMeanSamples, "2"}});
    for (const int shards : {1, 2, 5, 12}) {
        std::vector<fs::path> paths;
        for (int n = shards; n-- > 0;) paths.push_back(test::writePartOf(folder, test::partOf(n, shards), film));
        const shade::MergedPicture merged = shade::mergeParts(folder / "merged.exr", paths);
        EXPECT_EQ(merged.parts, shards);
        EXPECT_EQ(merged.mean_spp, 2.0);
        EXPECT_TRUE(test::bytesOf(folder / "merged.exr") == test::bytesOf(folder / "whole.exr")) << shards;
    }
}

TEST(MergeParts, NamesEverythingThatIsWrong) {
    const test::ScratchFolder folder;
    const shade::Film film = test::wholeFilm();
    std::vector<fs::path> paths;
    for (int n = 0; n < 4; ++n) paths.push_back(test::writePartOf(folder, test::partOf(n, 4), film));
    shade::Part other = test::partOf(1, 4);
    other.whole.exposure = 1.0;
    paths[1] = test::writePartOf(folder, other, film);
    paths[2] = paths[0];
    try {
        shade::mergeParts(folder / "merged.exr", paths);
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        for (const char* said : {"p.1of4.exr: is of another picture of the same scene", "p.0of4.exr: is shard 0 of 4",
                                 "shard 1 of 4 is missing", "shard 2 of 4 is missing", "nothing is written"})
            EXPECT_NE(text.find(said), std::string::npos) << said << " in " << text;
    }
    EXPECT_FALSE(fs::exists(folder / "merged.exr"));
}

}  // namespace
}  // namespace stratum
