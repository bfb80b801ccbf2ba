#include "shade/film/lossy_writers.h"

#include "base/own_file.h"

#include <fmt/format.h>
#include <webp/encode.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace stratum::shade {

namespace {

void appendLittle(std::vector<std::uint8_t>& bytes, std::size_t value, int count) {
    for (int n = 0; n < count; ++n) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * n)));
}

/// The same file with a chunk of XMP behind the picture that says which program it is of. Files with more than the
/// picture begin with a chunk VP8X. Source: WebP Container Specification, "Extended File Format".
std::vector<std::uint8_t> marked(const std::vector<std::uint8_t>& plain, int width, int height, bool alpha) {
    constexpr std::size_t kHead = 12;  // "RIFF", the size, "WEBP"
    constexpr std::string_view kExtended = "VP8X";
    const std::string xmp = fmt::format(
        "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>"
        "<rdf:Description xmlns:xmp='http://ns.adobe.com/xap/1.0/' xmp:CreatorTool='{}'/></rdf:RDF></x:xmpmeta>",
        kProgramMark);
    std::vector<std::uint8_t> bytes(plain.begin(), plain.begin() + kHead);
    const auto append = [&bytes](std::string_view text) { bytes.insert(bytes.end(), text.begin(), text.end()); };
    const std::string_view first(reinterpret_cast<const char*>(plain.data()) + kHead, kExtended.size());
    constexpr std::uint8_t kXmp = 4;
    if (first == kExtended) {
        bytes = plain;
        bytes[kHead + 8] |= kXmp;
    } else {
        append(kExtended);
        appendLittle(bytes, 10, 4);
        appendLittle(bytes, kXmp | (alpha ? 16U : 0U), 4);
        appendLittle(bytes, static_cast<std::size_t>(width) - 1, 3);
        appendLittle(bytes, static_cast<std::size_t>(height) - 1, 3);
        bytes.insert(bytes.end(), plain.begin() + kHead, plain.end());
    }
    append("XMP ");
    appendLittle(bytes, xmp.size(), 4);
    append(xmp);
    if (xmp.size() % 2 != 0) bytes.push_back(0);
    std::vector<std::uint8_t> size;
    appendLittle(size, bytes.size() - 8, 4);
    std::copy(size.begin(), size.end(), bytes.begin() + 4);
    return bytes;
}

}  // namespace

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
    return marked({writer.mem, writer.mem + writer.size}, width, height, alpha);
}

}  // namespace stratum::shade
