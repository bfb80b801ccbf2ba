#include "shade/film/png_reader.h"

#include <png.h>

#include <cstddef>

namespace stratum::shade {

std::optional<PngPixels> decodePng(std::string_view bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    PngPixels pixels;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return std::nullopt;
    image.format = PNG_FORMAT_RGB;
    pixels.width = static_cast<int>(image.width);
    pixels.height = static_cast<int>(image.height);
    pixels.rgb.resize(static_cast<std::size_t>(PNG_IMAGE_SIZE(image)));
    const int read = png_image_finish_read(&image, nullptr, pixels.rgb.data(), 0, nullptr);
    // A file that is cut short may be read with a warning alone.
    const bool whole = read != 0 && image.warning_or_error == 0;
    png_image_free(&image);
    if (!whole) return std::nullopt;
    return pixels;
}

}  // namespace stratum::shade
