#include "assemble/thumbnail/bmp_and_qoi.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <stdexcept>

namespace stratum::assemble {
namespace {

using Bytes = std::vector<std::uint8_t>;

// From the specification, and counts the kinds of chunks.
Bytes decode(const std::string& file, int& width, int& height, std::array<int, 6>& kinds) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned>(static_cast<unsigned char>(file.at(at))); };
    const auto big = [&](std::size_t at) {
        return byte(at) << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3);
    };
    EXPECT_EQ(file.substr(0, 4), "qoif");
    width = static_cast<int>(big(4));
    height = static_cast<int>(big(8));
    EXPECT_EQ(byte(12), 4U);
    EXPECT_EQ(byte(13), 0U);
    EXPECT_EQ(file.substr(file.size() - 8), std::string("\0\0\0\0\0\0\0\1", 8));
    std::array<std::array<std::uint8_t, 4>, 64> seen{};
    std::array<std::uint8_t, 4> p{0, 0, 0, 255};
    Bytes pixels;
    const auto put = [&] { pixels.insert(pixels.end(), p.begin(), p.end()); };
    for (std::size_t at = 14; at < file.size() - 8;) {
        const unsigned tag = byte(at++);
        if (tag == 0xff || tag == 0xfe) {
            for (std::size_t c = 0; c < (tag == 0xff ? 4U : 3U); ++c) p[c] = static_cast<std::uint8_t>(byte(at++));
            ++kinds[tag == 0xff ? 5 : 4];
        } else if (tag >> 6 == 3) {
            for (unsigned n = 0; n < (tag & 63); ++n) put();
            ++kinds[3];
        } else if (tag >> 6 == 0) {
            p = seen[tag];
            ++kinds[0];
        } else if (tag >> 6 == 1) {
            for (std::size_t c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>(p[c] + (tag >> (4 - 2 * c) & 3) - 2);
            ++kinds[1];
        } else {
            const unsigned more = byte(at++);
            const int green = static_cast<int>(tag & 63) - 32;
            p[0] = static_cast<std::uint8_t>(p[0] + green - 8 + static_cast<int>(more >> 4));
            p[1] = static_cast<std::uint8_t>(p[1] + green);
            p[2] = static_cast<std::uint8_t>(p[2] + green - 8 + static_cast<int>(more & 15));
            ++kinds[2];
        }
        seen[(p[0] * 3U + p[1] * 5U + p[2] * 7U + p[3] * 11U) % 64] = p;
        put();
    }
    return pixels;
}

TEST(Qoi, IsThePictureByEveryKindOfChunk) {
    constexpr int kWidth = 64, kHeight = 40;
    Bytes rgba;
    std::uint32_t noise = 7;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            noise = noise * 1664525 + 1013904223;
            const auto step = [&](int shift, int most) { return static_cast<int>(noise >> shift) % most; };
            if (y < 5) {
                rgba.insert(rgba.end(), {0, 0, 0, 0});  // long runs
            } else if (y < 15) {
                for (int c = 0; c < 3; ++c)
                    rgba.push_back(static_cast<std::uint8_t>(rgba[rgba.size() - 4] + (noise >> (8 + 4 * c)) % 4 - 2));
                rgba.push_back(200);
            } else if (y < 25) {
                const int green = static_cast<int>((noise >> 8) % 64) - 32;
                for (int c = 0; c < 3; ++c)
                    rgba.push_back(
                        static_cast<std::uint8_t>(rgba[rgba.size() - 4] + green +
                                                  (c == 1 ? 0 : static_cast<int>(noise >> (16 + 2 * c)) % 16 - 8)));
                rgba.push_back(200);
            } else if (y < 32) {
                for (int c = 0; c < 3; ++c) rgba.push_back(static_cast<std::uint8_t>(noise >> (8 * c + 8)));
                rgba.push_back(static_cast<std::uint8_t>(step(28, 2) * 255));
            } else {
                const auto gray = static_cast<std::uint8_t>(x % 3 * 90);  // seen before
                rgba.insert(rgba.end(), {gray, gray, gray, 255});
            }
        }
    const std::string file = encodeQoi(kWidth, kHeight, rgba);
    int width = 0;
    int height = 0;
    std::array<int, 6> kinds{};
    EXPECT_EQ(decode(file, width, height, kinds), rgba);
    EXPECT_EQ(width, kWidth);
    EXPECT_EQ(height, kHeight);
    for (std::size_t n = 0; n < kinds.size(); ++n) EXPECT_GT(kinds[n], 0) << n;
    EXPECT_EQ(file, encodeQoi(kWidth, kHeight, rgba));
}

TEST(Qoi, RefusesWhatIsNoPicture) {
    EXPECT_THROW((void)encodeQoi(3, 2, Bytes(23)), std::invalid_argument);
    EXPECT_THROW((void)encodeQoi(0, 2, {}), std::invalid_argument);
}

}  // namespace
}  // namespace stratum::assemble
