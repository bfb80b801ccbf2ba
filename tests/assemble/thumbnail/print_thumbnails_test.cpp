#include "assemble/thumbnail/print_thumbnails.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "gcode/thumbnail/thumbnail.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <memory>
#include <string>
#include <vector>

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

// Four layers of lines in two colors, with a skirt around them if asked for: no tag says what it is.
std::shared_ptr<const gcode::Toolpath> untagged(bool skirt) {
    std::string text = "G21\nG90\nM83\n";
    for (int layer = 0; layer < 4; ++layer) {
        text += fmt::format("G1 Z{:.1f} F3000\n", 0.2 * (layer + 1));
        if (layer == 2) text += "M600\n";
        if (skirt && layer == 0) text += "G0 X40 Y40\nG1 X80 E2\nG1 Y80 E2\nG1 X40 E2\nG1 Y40 E2\n";
        for (int line = 0; line < 12; ++line)
            text += fmt::format("G0 X55 Y{0:.1f}\nG1 X65 Y{0:.1f} E0.4\n", 57 + 0.4 * line);
    }
    return std::make_shared<const gcode::Toolpath>(gcode::readToolpath(text, "untagged.gcode"));
}

TEST(PrintThumbnails, ASkirtWithoutATagIsLeftOut) {
    const std::vector<gcode::ThumbnailSize> size{{40, 30, ThumbnailCoding::bmp}};
    EXPECT_EQ(makeThumbnails(untagged(true), "untagged.gcode", size).front().bytes,
              makeThumbnails(untagged(false), "untagged.gcode", size).front().bytes);
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
