#include "study/picture/thumbnail.h"

#include "base/base64.h"

#include <gtest/gtest.h>

namespace stratum::study {
namespace {

TEST(Thumbnail, IsTheMeanOfItsPixels) {
    shade::Film film(7, 5, {0, 0, 7, 5}, shade::FilmContent::unit);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x)
            film.at(x, y) = {shade::Color(static_cast<float>(x), static_cast<float>(y), 1.0f), x < 3 ? 1.0f : 0.0f};
    const shade::Film small = thumbnail(film, 2);
    EXPECT_EQ(small.width(), 3);
    EXPECT_EQ(small.height(), 2);
    EXPECT_EQ(small.content(), shade::FilmContent::unit);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            EXPECT_EQ(small.at(x, y).rgb,
                      shade::Color(2.0f * static_cast<float>(x) + 0.5f, 2.0f * static_cast<float>(y) + 0.5f, 1.0f));
    EXPECT_EQ(small.at(0, 0).alpha, 1.0f);
    EXPECT_EQ(small.at(1, 0).alpha, 0.5f);
    EXPECT_EQ(small.at(2, 0).alpha, 0.0f);
}

TEST(Thumbnail, IsAJpegInBase64) {
    const shade::Film film(8, 6, {0, 0, 8, 6}, shade::FilmContent::unit);
    EXPECT_TRUE(bytesOfBase64(jpegOf(film, 2)).starts_with("\xff\xd8"));
}

}  // namespace
}  // namespace stratum::study
