#include "shade/film/png.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum {
namespace {

std::string encoded(const std::vector<std::uint8_t>& rgb, shade::PngEffort effort) {
    const auto bytes = shade::encodePng(7, 5, rgb, {{"Software", "a test"}}, effort);
    return {bytes.begin(), bytes.end()};
}

TEST(PngReader, ReadsWhatWasWritten) {
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 7 * 5 * 3; ++i) rgb.push_back(static_cast<std::uint8_t>(i * 37));
    for (const auto effort : {shade::PngEffort::quick, shade::PngEffort::small}) {
        const auto back = shade::decodePng(encoded(rgb, effort));
        ASSERT_TRUE(back);
        EXPECT_EQ(back->width, 7);
        EXPECT_EQ(back->height, 5);
        EXPECT_EQ(back->rgb, rgb);
    }
}

TEST(PngReader, TakesNoDamagedFile) {
    const std::string whole = encoded(std::vector<std::uint8_t>(7 * 5 * 3, 9), shade::PngEffort::quick);
    EXPECT_FALSE(shade::decodePng(""));
    EXPECT_FALSE(shade::decodePng("no PNG"));
    const std::size_t data = whole.find("IDAT");
    for (std::size_t end = 0; end < data + 8; ++end) EXPECT_FALSE(shade::decodePng(whole.substr(0, end))) << end;
    for (std::size_t at = data + 4; at < data + 12; ++at) {
        std::string other = whole;
        other[at] = static_cast<char>(other[at] ^ 0x55);
        EXPECT_FALSE(shade::decodePng(other)) << at;
    }
}

}  // namespace
}  // namespace stratum
