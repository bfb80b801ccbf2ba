#include "animate/encode/apng_writer.h"

#include "base/error.h"
#include "base/input_file.h"
#include "scratch_folder.h"
#include "shade/film/png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>

namespace stratum::animate {
namespace {

constexpr int kWidth = 33;
constexpr int kHeight = 17;
using Picture = std::vector<std::uint8_t>;

std::uint32_t number(std::string_view bytes, std::size_t at, std::size_t length = 4) {
    std::uint32_t value = 0;
    for (std::size_t n = 0; n < length; ++n) value = value << 8 | static_cast<unsigned char>(bytes[at + n]);
    return value;
}

struct FrameControl {
    std::uint32_t width, height, x, y, delay_num, delay_den;
};

/// What a player does, from the specification: chunks in order with right checksums, ascending sequence numbers, each
/// frame a PNG of its own that replaces a rectangle.
struct Played {
    std::vector<Picture> frames;
    std::vector<FrameControl> controls;
    std::vector<std::string> types;
    std::uint32_t stated_frames = 0, plays = 1;
};

std::string chunk(const std::string& type, const std::string& data) {
    const auto append = [](std::string& to, std::uint32_t value) {
        for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<char>(value >> shift));
    };
    std::string bytes;
    append(bytes, static_cast<std::uint32_t>(data.size()));
    const std::string body = type + data;
    bytes += body;
    append(bytes, static_cast<std::uint32_t>(
                      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()))));
    return bytes;
}

Played play(const std::filesystem::path& path) {
    const InputFile file(path);
    const std::string_view bytes = file.bytes();
    const std::string signature(bytes.substr(0, 8));
    std::string head;
    std::string data;
    Played played;
    Picture canvas(3 * kWidth * kHeight, 0);
    std::uint32_t sequence = 0;
    const auto show = [&] {
        if (data.empty()) return;
        const FrameControl& at = played.controls.back();
        std::string size = head.substr(0, 13);
        for (int n = 0; n < 4; ++n) {
            size[static_cast<std::size_t>(n)] = static_cast<char>(at.width >> (24 - 8 * n));
            size[static_cast<std::size_t>(4 + n)] = static_cast<char>(at.height >> (24 - 8 * n));
        }
        const auto part = shade::decodePng(signature + chunk("IHDR", size) + chunk("IDAT", data) + chunk("IEND", ""));
        ASSERT_TRUE(part) << "frame " << played.frames.size();
        for (std::uint32_t y = 0; y < at.height; ++y)
            std::copy_n(part->rgb.begin() + 3 * y * at.width, 3 * at.width,
                        canvas.begin() + 3 * ((at.y + y) * kWidth + at.x));
        played.frames.push_back(canvas);
        data.clear();
    };
    for (std::size_t at = 8; at < bytes.size();) {
        const std::uint32_t length = number(bytes, at);
        const std::string type(bytes.substr(at + 4, 4));
        const std::string_view body = bytes.substr(at + 8, length);
        const std::string_view checked = bytes.substr(at + 4, length + 4);
        EXPECT_EQ(number(bytes, at + 8 + length),
                  crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())))
            << type;
        played.types.push_back(type);
        if (type == "IHDR") head = body;
        if (type == "acTL") {
            played.stated_frames = number(body, 0);
            played.plays = number(body, 4);
        }
        if (type == "fcTL") {
            show();
            EXPECT_EQ(number(body, 0), sequence++);
            played.controls.push_back({number(body, 4), number(body, 8), number(body, 12), number(body, 16),
                                       number(body, 20, 2), number(body, 22, 2)});
            EXPECT_EQ(body.size(), 26u);
            EXPECT_EQ(body[24], 0);
            EXPECT_EQ(body[25], 0);
        }
        if (type == "IDAT") data += body;
        if (type == "fdAT") {
            EXPECT_EQ(number(body, 0), sequence++);
            data += body.substr(4);
        }
        if (type == "IEND") show();
        at += 12 + length;
    }
    return played;
}

std::vector<Picture> movingSquare(int count) {
    std::mt19937 random(1);
    Picture ground(3 * kWidth * kHeight);
    for (std::uint8_t& value : ground) value = static_cast<std::uint8_t>(random());
    std::vector<Picture> frames;
    for (int n = 0; n < count; ++n) {
        Picture frame = ground;
        for (int y = n; y < n + 3; ++y)
            for (int x = 2 * n; x < 2 * n + 4; ++x) frame[static_cast<std::size_t>(3 * (y * kWidth + x))] ^= 0xff;
        frames.push_back(frame);
    }
    return frames;
}

FilmFormat formatOf(std::size_t frames) {
    FilmFormat format;
    format.width = kWidth;
    format.height = kHeight;
    format.frames = frames;
    format.rate = 24;
    format.metadata = {{"Software", "a test"}};
    return format;
}

TEST(ApngWriter, PlaysBackEveryFrame) {
    const test::ScratchFolder folder;
    std::vector<Picture> frames = movingSquare(10);
    frames.push_back(frames.back());  // nothing changes
    frames.push_back(frames.front());
    ApngWriter film(folder / "a.png", formatOf(frames.size()));
    for (const Picture& frame : frames) film.add(frame);
    EXPECT_TRUE(!std::filesystem::exists(folder / "a.png"));  // before it is whole
    film.finish();
    const Played played = play(folder / "a.png");
    EXPECT_EQ(played.frames, frames);
    EXPECT_EQ(played.stated_frames, frames.size());
    EXPECT_EQ(played.plays, 0u);
    for (const FrameControl& control : played.controls) {
        EXPECT_EQ(control.delay_num, 1u);
        EXPECT_EQ(control.delay_den, 24u);
    }
    // Only what changes: two squares of 4 x 3, one pixel down and two to the right of each other.
    EXPECT_EQ(played.controls[4].width, 6u);
    EXPECT_EQ(played.controls[4].height, 4u);
    EXPECT_EQ(played.controls[4].x, 6u);
    EXPECT_EQ(played.controls[4].y, 3u);
    EXPECT_EQ(played.controls[10].width * played.controls[10].height, 1u);
    // In the order that the specification asks for.
    const auto first = [&](const std::string& type) {
        return std::find(played.types.begin(), played.types.end(), type) - played.types.begin();
    };
    EXPECT_EQ(first("IHDR"), 0);
    EXPECT_LT(first("acTL"), first("fcTL"));
    EXPECT_LT(first("fcTL"), first("IDAT"));
    EXPECT_LT(first("IDAT"), first("fdAT"));
    EXPECT_NE(std::find(played.types.begin(), played.types.end(), "tEXt"), played.types.end());
    EXPECT_EQ(played.types.back(), "IEND");
}

TEST(ApngWriter, ProgramsWithoutAnimationShowTheFirstFrame) {
    const test::ScratchFolder folder;
    const std::vector<Picture> frames = movingSquare(3);
    ApngWriter film(folder / "a.png", formatOf(3));
    for (const Picture& frame : frames) film.add(frame);
    film.finish();
    const InputFile file(folder / "a.png");
    const auto shown = shade::decodePng(file.bytes());
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->rgb, frames.front());
}

TEST(ApngWriter, AnUnfinishedFilmLeavesNothing) {
    const test::ScratchFolder folder;
    {
        ApngWriter film(folder / "a.png", formatOf(3));
        film.add(movingSquare(1).front());
        EXPECT_THROW(film.finish(), std::logic_error);
        EXPECT_THROW(film.add(Picture(3)), std::logic_error);
    }
    EXPECT_TRUE(folder.empty());
    EXPECT_THROW(ApngWriter(folder / "none/a.png", formatOf(3)), OutputError);
}

}  // namespace
}  // namespace stratum::animate
