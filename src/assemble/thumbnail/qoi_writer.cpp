#include "assemble/thumbnail/qoi_writer.h"

#include "base/big_endian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>

namespace stratum::assemble {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

// The first bits of each kind of chunk.
constexpr unsigned kIndex = 0x00;
constexpr unsigned kDiff = 0x40;
constexpr unsigned kLuma = 0x80;
constexpr unsigned kRun = 0xc0;
constexpr unsigned kRgb = 0xfe;
constexpr unsigned kRgba = 0xff;
constexpr int kLongestRun = 62;

class Encoder {
public:
    void add(const Rgba& pixel) {
        if (pixel == last_) {
            if (++run_ == kLongestRun) endRun();
            return;
        }
        endRun();
        const std::size_t place = (pixel[0] * 3u + pixel[1] * 5u + pixel[2] * 7u + pixel[3] * 11u) % 64u;
        if (seen_[place] == pixel)
            put(kIndex | static_cast<unsigned>(place));
        else
            change(pixel);
        seen_[place] = pixel;
        last_ = pixel;
    }
    void endRun() {
        if (run_ > 0) put(kRun | static_cast<unsigned>(run_ - 1));
        run_ = 0;
    }
    void put(unsigned byte) { bytes += static_cast<char>(byte); }

    std::string bytes;

private:
    void change(const Rgba& pixel) {
        if (pixel[3] != last_[3]) {
            put(kRgba);
            for (const std::uint8_t value : pixel) put(value);
            return;
        }
        // Differences wrap around.
        const auto differs = [&](std::size_t c) {
            return static_cast<int>(static_cast<std::int8_t>(static_cast<std::uint8_t>(pixel[c] - last_[c])));
        };
        const int red = differs(0);
        const int green = differs(1);
        const int blue = differs(2);
        const auto within = [](int value, int reach) { return value >= -reach && value < reach; };
        if (within(red, 2) && within(green, 2) && within(blue, 2)) {
            put(kDiff | static_cast<unsigned>((red + 2) << 4 | (green + 2) << 2 | (blue + 2)));
        } else if (within(green, 32) && within(red - green, 8) && within(blue - green, 8)) {
            put(kLuma | static_cast<unsigned>(green + 32));
            put(static_cast<unsigned>((red - green + 8) << 4 | (blue - green + 8)));
        } else {
            put(kRgb);
            for (std::size_t c = 0; c < 3; ++c) put(pixel[c]);
        }
    }

    std::array<Rgba, 64> seen_{};
    Rgba last_{0, 0, 0, 255};
    int run_ = 0;
};

}  // namespace

std::string encodeQoi(int width, int height, const std::vector<std::uint8_t>& rgba) {
    if (width < 1 || height < 1 ||
        rgba.size() != 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGBA picture of that size");
    Encoder encoder;
    encoder.bytes = "qoif";
    appendBigEndian32(encoder.bytes, static_cast<std::uint32_t>(width));
    appendBigEndian32(encoder.bytes, static_cast<std::uint32_t>(height));
    encoder.put(4);  // channels
    encoder.put(0);  // sRGB with linear alpha
    for (std::size_t at = 0; at < rgba.size(); at += 4)
        encoder.add({rgba[at], rgba[at + 1], rgba[at + 2], rgba[at + 3]});
    encoder.endRun();
    encoder.bytes.append(7, '\0');
    encoder.put(1);
    return std::move(encoder.bytes);
}

}  // namespace stratum::assemble
