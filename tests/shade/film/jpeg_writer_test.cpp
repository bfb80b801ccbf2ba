#include "shade/film/lossy_writers.h"

#include "shade/film/gradient.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdio>  // jpeglib.h needs it before it

#include <jpeglib.h>

#include <stdexcept>
#include <string>

namespace stratum::shade {
namespace {

struct Decoded {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    std::vector<std::string> comments;
};

Decoded decode(const std::vector<std::uint8_t>& file) {
    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    errors.error_exit = [](j_common_ptr) { throw std::runtime_error("no JPEG"); };
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, file.data(), static_cast<unsigned long>(file.size()));
    jpeg_save_markers(&jpeg, JPEG_COM, 0xffff);
    jpeg_read_header(&jpeg, TRUE);
    jpeg_start_decompress(&jpeg);
    Decoded picture{static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height), {}, {}};
    picture.rgb.resize(std::size_t{3} * jpeg.output_width * jpeg.output_height);
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = picture.rgb.data() + std::size_t{3} * jpeg.output_width * jpeg.output_scanline;
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    for (const auto* marker = jpeg.marker_list; marker != nullptr; marker = marker->next)
        picture.comments.emplace_back(reinterpret_cast<const char*>(marker->data), marker->data_length);
    jpeg_finish_decompress(&jpeg);
    jpeg_destroy_decompress(&jpeg);
    return picture;
}

TEST(Jpeg, IsThePicture) {
    const std::vector<std::uint8_t> rgb = test::gradient(133, 77);
    const Decoded back = decode(encodeJpeg(133, 77, rgb, 92, {{"Software", "test"}, {"Source", "a.gcode"}}));
    EXPECT_EQ(back.width, 133);
    EXPECT_EQ(back.height, 77);
    EXPECT_EQ(back.comments, (std::vector<std::string>{"Software: test", "Source: a.gcode"}));
    EXPECT_LT(test::meanDifference(rgb, back.rgb), 1.0);
}

TEST(Jpeg, CommentsThatAreTooLongAreCut) {
    const Decoded back = decode(encodeJpeg(1, 1, {1, 2, 3}, 92, {{"Long", std::string(100000, 'x')}}));
    ASSERT_EQ(back.comments.size(), 1U);
    EXPECT_EQ(back.comments[0].size(), 65533U);
}

TEST(Jpeg, RefusesWhatIsNoPicture) {
    const std::vector<std::uint8_t> rgb(std::size_t{3} * 33 * 17);
    EXPECT_THROW((void)encodeJpeg(33, 18, rgb, 80), std::invalid_argument);
    EXPECT_THROW((void)encodeJpeg(0, 17, {}, 80), std::invalid_argument);
    EXPECT_THROW((void)encodeJpeg(kJpegMostSide + 1, 1, std::vector<std::uint8_t>(3 * (kJpegMostSide + 1)), 80),
                 std::runtime_error);
}

}  // namespace
}  // namespace stratum::shade
