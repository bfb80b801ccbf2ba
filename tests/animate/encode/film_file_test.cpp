#include "animate/encode/film_file.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

namespace stratum::animate {
namespace {

FilmFormat formatOf(int width, int height, std::size_t frames, double rate) {
    FilmFormat format;
    format.width = width;
    format.height = height;
    format.frames = frames;
    format.rate = rate;
    return format;
}

std::string complaint(const std::string& path, const FilmFormat& format) {
    return test::messageOf<UsageError>([&] { requireFilm(path, format); }, "none");
}

TEST(FilmFile, ItsKindIsThatOfItsName) {
    EXPECT_EQ(filmKindOf("a.mp4"), FilmKind::mp4);
    EXPECT_EQ(filmKindOf("b/a.WEBM"), FilmKind::webm);
    EXPECT_EQ(filmKindOf("a.gif"), FilmKind::gif);
    EXPECT_EQ(filmKindOf("a.png"), FilmKind::apng);
    EXPECT_EQ(filmKindOf("a.apng"), FilmKind::apng);
    for (const char* name : {"a", "a.avi", "a.jpg", "-"}) EXPECT_THROW((void)filmKindOf(name), UsageError) << name;
}

TEST(FilmFile, RatesOfTelevisionAreRatios) {
    for (const auto& [written, frames, seconds] : {std::tuple{23.976, 24000, 1001},
                                                   {29.97, 30000, 1001},
                                                   {59.94, 60000, 1001},
                                                   {24.0, 24, 1},
                                                   {30.0, 30, 1},
                                                   {1.0, 1, 1},
                                                   {240.0, 240, 1},
                                                   {12.5, 1250, 100}}) {
        EXPECT_EQ(ratioOf(written).frames, frames) << written;
        EXPECT_EQ(ratioOf(written).seconds, seconds) << written;
        EXPECT_NEAR(ratioOf(ratioOf(written).perSecond()).perSecond(), written, 0.005) << written;
    }
}

TEST(FilmFile, RefusesWhatItCanNotBe) {
    const auto mentions = [](const std::string& text, const std::string& said) {
        EXPECT_NE(said.find(text), std::string::npos) << said;
    };
    mentions("has no frames", complaint("a.mp4", formatOf(64, 48, 0, 30)));
    mentions("--size 64x48", complaint("a.mp4", formatOf(63, 47, 9, 30)));
    mentions("--size 64x48", complaint("a.webm", formatOf(64, 47, 9, 30)));
    mentions("1 to 50", complaint("a.gif", formatOf(64, 48, 9, 60)));
    mentions("1 to 240", complaint("a.mp4", formatOf(64, 48, 9, 241)));
    mentions("must keep all frames", complaint("a.gif", formatOf(30000, 30000, 100000, 50)));
    mentions("standard output", complaint("-.mp4", formatOf(64, 48, 9, 30)));
    EXPECT_EQ(complaint("a.png", formatOf(63, 47, 9, 240)), "none");
    EXPECT_EQ(complaint("a.gif", formatOf(63, 47, 9, 50)), "none");
    EXPECT_EQ(complaint("a.mp4", formatOf(64, 48, 1, 30)), "none");
}

}  // namespace
}  // namespace stratum::animate
