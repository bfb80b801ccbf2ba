#include "shade/environment/hdr_reader.h"

#include "base/error.h"
#include "shade/map_files.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;
using shade::readHdr;

const std::vector<Color> kTexels = {{1, 0.5, 0.25}, {0, 0, 0}, {64, 128, 0}, {0.125, 0.25, 0.25},
                                    {2, 2, 2},      {1, 1, 1}, {4, 4, 4},    {0.5, 0.5, 0.5}};

TEST(HdrReader, ReadsTexelsAndOddHeaderLines) {
    for (const char* header : {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n",
                               "#?RADIANCE\n# Made by hand\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\nSOFTWARE=x y\n"
                               "FORMAT=32-bit_rle_rgbe\n",
                               "#?RGBE\nFORMAT=32-bit_rle_rgbe\n"}) {
        const auto map = readHdr(test::hdrBytes(header, 4, 2, kTexels), "t.hdr");
        ASSERT_EQ(map.width, 4);
        ASSERT_EQ(map.height, 2);
        for (std::size_t i = 0; i < kTexels.size(); ++i)
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(map.texels[i][k], kTexels[i][k], 0.01f * kTexels[i][k]);
    }
}

TEST(HdrReader, UndoesExposure) {
    const auto map = readHdr(
        test::hdrBytes("#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4.0\nFORMAT=32-bit_rle_rgbe\n", 4, 2, kTexels), "t.hdr");
    EXPECT_NEAR(map.texels[4].r, 0.25f, 1e-3f);
}

TEST(HdrReader, RefusesDamage) {
    const std::string good = test::hdrBytes("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", 4, 2, kTexels);
    for (std::size_t length = 0; length < good.size(); ++length)
        EXPECT_THROW(readHdr(std::string_view(good).substr(0, length), "t.hdr"), InputError) << length;
    for (const char* text : {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 4\n", "#?RADIANCE\n\n-Y 2 +X 4\n",
                             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+Y 2 +X 4\n",
                             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999 +X 199999\n",
                             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y -2 +X 4\n",
                             "#?RADIANCE\nEXPOSURE=0\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n",
                             "#?RADIANCE\nCOLORCORR=1 1\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n",
                             "#?RADIANCE\nPRIMARIES=1 2 nan\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"})
        EXPECT_THROW(readHdr(text, "t.hdr"), InputError) << text;
}

}  // namespace
}  // namespace stratum
