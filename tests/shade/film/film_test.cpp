#include "shade/film/film.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(Film, IsAddressedByTheFrame) {
    shade::Film film(100, 80, {10, 20, 13, 22}, shade::FilmContent::depth);
    EXPECT_EQ(film.width(), 3);
    EXPECT_EQ(film.height(), 2);
    EXPECT_EQ(film.pixels().size(), 6u);
    film.at(12, 21).alpha = 0.5f;
    EXPECT_EQ(film.pixels()[5].alpha, 0.5f);
    EXPECT_EQ(film.content(), shade::FilmContent::depth);
    EXPECT_EQ(film.frameWidth(), 100);
}

}  // namespace
}  // namespace stratum
