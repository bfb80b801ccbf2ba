#include "shade/environment/light_map.h"

#include "base/error.h"
#include "corpus.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

#include <limits>

namespace stratum {
namespace {

using shade::Color;
using shade::readLightMap;

TEST(LightMap, ContentDecidesNotTheName) {
    const test::ScratchFolder scratch;
    const std::vector<Color> texels = {{1, 2, 3}, {0.5, 0.5, 0.5}};
    const auto path = scratch.path() / "map.txt";
    test::writeExrMap(path, 2, 1, texels);
    EXPECT_EQ(readLightMap(path).texels, texels);
    test::writeText(path, test::hdrBytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", 2, 1, texels));
    EXPECT_NEAR(readLightMap(path).at(0, 0).b, 3.0f, 0.02f);
}

TEST(LightMap, RefusesWhatGivesNoPicture) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "map.exr";
    const auto refused = [&](int width, int height, const std::vector<Color>& texels, const char* word) {
        test::writeExrMap(path, width, height, texels);
        EXPECT_TRUE(test::refuses<InputError>(word, [&] { readLightMap(path); })) << word;
    };
    refused(2, 1, {{1, 1, 1}, {std::nanf(""), 0, 0}}, "texel 1, 0");
    refused(2, 1, {{1, -1, 1}, {0, 0, 0}}, "33.3 %");
    refused(2, 1, {{std::numeric_limits<float>::infinity(), 1, 1}, {0, 0, 0}}, "texel 0, 0");
    refused(2, 1, {{0, 0, 0}, {0, 0, 0}}, "black");
    refused(2, 2, std::vector<Color>(4, Color(1.0f)), "twice as wide");
    test::writeText(path, "P6 nothing of the kind");
    EXPECT_THROW(readLightMap(path), InputError);
    test::writeExrMap(path, 64, 32, std::vector<Color>(2048, Color(0.3f, 0.1f, 0.7f)));
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    EXPECT_THROW(readLightMap(path), InputError);
    EXPECT_THROW(readLightMap(scratch.path() / "none.exr"), InputError);
}

TEST(LightMap, TakesALittleNegativeLightAsNone) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "map.exr";
    test::writeExrMap(path, 2, 1, {{1, -0.01f, 1}, {-1e-6f, 0.5f, 0}});
    EXPECT_EQ(readLightMap(path).texels, (std::vector<Color>{{1, 0, 1}, {0, 0.5f, 0}}));
}

TEST(LightMap, ScalesAndChecksAfterwards) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "map.exr";
    test::writeExrMap(path, 2, 1, {{1, 2, 3}, {0, 0, 0}});
    EXPECT_EQ(readLightMap(path, 2.0).texels.front(), Color(4, 8, 12));
    EXPECT_EQ(readLightMap(path, -1.0).texels.front(), Color(0.5f, 1.0f, 1.5f));
    EXPECT_THROW(readLightMap(path, 40.0), InputError);
    for (const float bright : {3e38f, 1e30f, 2e12f}) {
        test::writeExrMap(path, 2, 1, {{1, 2, 3}, {0, bright, 0}});
        EXPECT_THROW(readLightMap(path), InputError) << bright;
    }
    // Too dark to be told from black.
    test::writeExrMap(path, 2, 1, {{1e-38f, 0, 0}, {0, 0, 0}});
    EXPECT_THROW(readLightMap(path, -30.0), InputError);
}

TEST(LightMap, ReadsRealMaps) {
    STRATUM_NEEDS_CORPUS(hills, "env/golden_gate_hills_1k.hdr");
    STRATUM_NEEDS_CORPUS(studio, "env/studio_small_03_1k.hdr");
    const auto map = readLightMap(hills);
    EXPECT_EQ(map.width, 1024);
    float peak = 0.0f;
    for (const Color& c : map.texels) peak = std::max(peak, shade::maxComponent(c));
    EXPECT_GT(peak, 5e4f);  // the sun
    EXPECT_EQ(readLightMap(studio).height, 512);
}

}  // namespace
}  // namespace stratum
