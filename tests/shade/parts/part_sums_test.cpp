#include "shade/parts/part_sums.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/analytic_prints.h"
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

constexpr const char* kLayers = "normal,depth,albedo,mask,variance,samples,layer";

shade::RenderOptions optionsOf(int spp) {
    shade::RenderOptions options;
    options.width = 75;
    options.height = 45;
    options.spp = spp;
    options.aovs = shade::parseAovs(kLayers);
    return options;
}

shade::RenderResult traced(const shade::RenderOptions& options) {
    test::Vase vase;
    vase.layers = 30;
    const auto print = vase.intersector();
    return shade::render(print, shade::makeScene({}, print, options.width, options.height), options);
}

fs::path writeShare(const test::ScratchFolder& folder, shade::RenderOptions options, const Shard& shard) {
    options.samples = shade::samplesOf(options.spp, shard);
    const shade::RenderResult result = traced(options);
    shade::Part part;
    part.whole = {"1", "s", options.width, options.height, options.region(), {}, true, false,
                  0.0, {},  shard.count,   options.spp};
    part.index = shard.index;
    part.samples = result.samples;
    part.pixels = result.pixels;
    part.metadata = {{"Software", "test"}, {shade::kMeanSamples, std::to_string(result.mean_spp)}};
    const fs::path path = shardName(folder / "p.exr", shard);
    shade::PictureFile file(path);
    shade::writePart(file, result.film, result.sums, part);
    return path;
}

TEST(PartSums, MergeToTheBytesOfTheWholePicture) {
    const test::ScratchFolder folder;
    const shade::RenderOptions options = optionsOf(7);
    shade::PictureFile(folder / "whole.exr")
        .write(traced(options).film, {{"Software", "test"}, {shade::kMeanSamples, "7"}});
    for (const int shards : {1, 2, 7}) {
        std::vector<fs::path> paths;
        for (int n = shards; n-- > 0;) paths.push_back(writeShare(folder, options, {n, shards}));
        const shade::MergedPicture merged = shade::mergeParts(folder / "merged.exr", paths);
        EXPECT_EQ(merged.parts, shards);
        EXPECT_EQ(merged.mean_spp, 7.0);
        EXPECT_TRUE(test::bytesOf(folder / "merged.exr") == test::bytesOf(folder / "whole.exr")) << shards;
    }
}

TEST(PartSums, AreAPartOfTheirKindAlone) {
    const test::ScratchFolder folder;
    const fs::path path = writeShare(folder, optionsOf(3), {1, 3});
    EXPECT_TRUE(shade::isPartOf(path, "1", "s", {1, 3}, true));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {1, 3}, false));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {0, 3}, true));
    EXPECT_FALSE(shade::isPartOf(path, "1", "t", {1, 3}, true));
    const shade::Part share = shade::readPart(path);
    shade::Part piece = share;
    piece.whole.spp = 0;
    EXPECT_EQ(shade::differenceOf(share, piece), "a share of the samples, not a piece of the picture");
    EXPECT_EQ(shade::differenceOf(piece, share), "a piece of the picture, not a share of the samples");
}

// Whatever is cut off or changed in a share: it is refused, or gives the same picture.
TEST(PartSums, DamageIsNeverMerged) {
    const test::ScratchFolder folder;
    const std::vector<fs::path> paths = {writeShare(folder, optionsOf(2), {0, 2}),
                                         writeShare(folder, optionsOf(2), {1, 2})};
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
    for (std::size_t at = 0; at < good.size(); at += 1 + at / 100) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x01);  // a digit becomes another
        attempt(bytes, at);
    }
}

TEST(PartSums, ShareTheSamples) {
    for (const int spp : {1, 2, 7, 16})
        for (int shards = 1; shards <= spp; ++shards) {
            int next = 0;
            for (int n = 0; n < shards; ++n) {
                const shade::SampleRange range = shade::samplesOf(spp, {n, shards});
                EXPECT_EQ(range.first, next);
                EXPECT_GT(range.end, range.first);
                next = range.end;
            }
            EXPECT_EQ(next, spp);
        }
    EXPECT_THROW((void)shade::samplesOf(4, {0, 5}), UsageError);
}

TEST(PartSums, NeedAFixedNumberOfSamples) {
    shade::RenderOptions options = optionsOf(4);
    options.samples = shade::SampleRange{0, 2};
    EXPECT_NO_THROW(options.validate());
    options.noise = 0.1;
    EXPECT_THROW(options.validate(), UsageError);
    options.noise = 0.0;
    options.checkpoint = "state";
    EXPECT_THROW(options.validate(), UsageError);
    options.checkpoint.clear();
    options.samples = shade::SampleRange{2, 5};
    EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace stratum
