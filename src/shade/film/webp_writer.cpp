#include "shade/film/webp_writer.h"

#include <webp/encode.h>

#include <cstddef>
#include <memory>
#include <stdexcept>

namespace stratum::shade {

std::vector<std::uint8_t> encodeWebp(int width, int height, const std::vector<std::uint8_t>& pixels, int quality) {
    const std::size_t area =
        width < 1 || height < 1 ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (area == 0 || (pixels.size() != 3 * area && pixels.size() != 4 * area))
        throw std::invalid_argument("these bytes are no RGB or RGBA picture of that size");
    const bool alpha = pixels.size() == 4 * area;
    WebPConfig config;
    WebPPicture picture;
    if (!WebPConfigPreset(&config, WEBP_PRESET_PICTURE, static_cast<float>(quality)) || !WebPPictureInit(&picture))
        throw std::runtime_error("libwebp is of another version than its header");
    config.use_sharp_yuv = 1;
    picture.width = width;
    picture.height = height;
    picture.use_argb = 1;
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    const std::unique_ptr<WebPPicture, decltype(&WebPPictureFree)> picture_owner(&picture, &WebPPictureFree);
    const std::unique_ptr<WebPMemoryWriter, decltype(&WebPMemoryWriterClear)> writer_owner(&writer,
                                                                                           &WebPMemoryWriterClear);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    const bool imported = alpha ? WebPPictureImportRGBA(&picture, pixels.data(), 4 * width)
                                : WebPPictureImportRGB(&picture, pixels.data(), 3 * width);
    if (!imported || !WebPEncode(&config, &picture)) throw std::runtime_error("libwebp can't encode the picture");
    return {writer.mem, writer.mem + writer.size};
}

}  // namespace stratum::shade
