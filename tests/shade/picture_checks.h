// Reading back what the writers wrote.
#pragma once

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace stratum::test {

struct PngPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    std::map<std::string, std::string> texts;
};

inline PngPicture readPng(const std::filesystem::path& path) {
    PngPicture picture;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw std::runtime_error("no file " + path.string());
    png_structp png = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp, png_const_charp m) { throw std::runtime_error(m); }, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    picture.width = static_cast<int>(png_get_image_width(png, info));
    picture.height = static_cast<int>(png_get_image_height(png, info));
    EXPECT_EQ(png_get_bit_depth(png, info), 8);
    EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB);
    png_bytepp rows = png_get_rows(png, info);
    for (int y = 0; y < picture.height; ++y)
        picture.rgb.insert(picture.rgb.end(), rows[y], rows[y] + 3 * picture.width);
    png_textp text = nullptr;
    int count = 0;
    png_get_text(png, info, &text, &count);
    for (int i = 0; i < count; ++i) picture.texts[text[i].key] = text[i].text;
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return picture;
}

}  // namespace stratum::test
