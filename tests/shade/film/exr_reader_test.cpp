#include "shade/film/exr.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Color;
using shade::readExr;

TEST(ExrReader, ReadsBackWhatTheWriterWrote) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "film.exr";
    shade::Film film(8, 6, {2, 1, 6, 4});
    for (int y = 1; y < 4; ++y)
        for (int x = 2; x < 6; ++x) film.at(x, y) = {Color(float(x), float(y), 0.5f), 1.0f};
    shade::writeExr(path, film, {{"Note", "by hand"}});
    const auto image = readExr(path, 1000);
    ASSERT_EQ(image.width, 4);
    ASSERT_EQ(image.height, 3);
    EXPECT_EQ(image.rgb[0], Color(2.0f, 1.0f, 0.5f));
    EXPECT_EQ(image.rgb[11], Color(5.0f, 3.0f, 0.5f));
    EXPECT_EQ(image.attributes.at("Note"), "by hand");
}

TEST(ExrReader, RefusesWhatIsTooLargeOrNoExr) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "map.exr";
    test::writeExrMap(path, 8, 4, std::vector<Color>(32, Color(1.0f)));
    EXPECT_THROW(readExr(path, 31), InputError);
    EXPECT_NO_THROW(readExr(path, 32));
    test::writeText(path, "v/1\x01 but no more");
    EXPECT_THROW(readExr(path, 1000), InputError);
}

}  // namespace
}  // namespace stratum
