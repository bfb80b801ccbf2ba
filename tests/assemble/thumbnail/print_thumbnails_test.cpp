#include "assemble/thumbnail/print_thumbnails.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "gcode/thumbnail/png_size.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <string>

namespace stratum::assemble {
namespace {

using gcode::ThumbnailCoding;

std::shared_ptr<const gcode::Toolpath> tile() {
    const InputFile file(test::dataDir() / "gcode/tile.gcode");
    return std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "tile.gcode"));
}

TEST(PrintThumbnails, OneForEachSizeInItsCoding) {
    const std::vector<gcode::ThumbnailSize> sizes{{40, 24, ThumbnailCoding::png},
                                                  {16, 16, ThumbnailCoding::qoi},
                                                  {40, 24, ThumbnailCoding::jpg},
                                                  {80, 60, ThumbnailCoding::bmp}};
    const std::vector<gcode::Thumbnail> made = makeThumbnails(tile(), "tile.gcode", sizes);
    ASSERT_EQ(made.size(), 4U);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(made[n].size, sizes[n]);
    EXPECT_EQ(gcode::pngSize(made[0].bytes), sizes[0]);
    EXPECT_TRUE(made[1].bytes.starts_with("qoif"));
    EXPECT_TRUE(made[2].bytes.starts_with("\xff\xd8\xff"));
    ASSERT_EQ(made[3].bytes.size(), 14454U);
    // Orange plastic in the middle, black corners.
    const auto bmp = [&](int x, int y, int c) {
        return static_cast<unsigned char>(made[3].bytes[static_cast<std::size_t>(54 + 3 * (y * 80 + x) + c)]);
    };
    for (const int c : {0, 1, 2}) EXPECT_EQ(bmp(0, 0, c), 0);
    EXPECT_GT(bmp(40, 30, 2), bmp(40, 30, 0));
    EXPECT_GT(bmp(40, 30, 2), 80);
}

TEST(PrintThumbnails, SameBytesForAnyNumberOfThreads) {
    const std::vector<gcode::ThumbnailSize> sizes{{120, 100, ThumbnailCoding::png}, {20, 20, ThumbnailCoding::qoi}};
    const auto toolpath = tile();
    const auto many = makeThumbnails(toolpath, "tile.gcode", sizes);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto few = makeThumbnails(toolpath, "tile.gcode", sizes);
    for (std::size_t n = 0; n < sizes.size(); ++n) EXPECT_EQ(many[n].bytes, few[n].bytes);
}

}  // namespace
}  // namespace stratum::assemble
