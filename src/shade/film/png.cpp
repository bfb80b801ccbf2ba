#include "shade/film/png.h"

#include "base/error.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

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

namespace {

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

void checkKeyword(const std::string& keyword) {
    const bool printable =
        std::all_of(keyword.begin(), keyword.end(), [](unsigned char c) { return c >= 32 && c < 127; });
    if (keyword.empty() || keyword.size() > 79 || !printable || keyword.front() == ' ' || keyword.back() == ' ')
        throw std::invalid_argument(fmt::format("'{}' can't be the keyword of a PNG text", keyword));
}

/// Output state of libpng. Trivially destructible, because libpng's errors longjmp over it.
struct PngJob {
    std::FILE* file;
    png_uint_32 width, height;
    png_bytepp rows;
    png_textp texts;
    int text_count;
    PngEffort effort;
    int color_type;
};

/// False if libpng reported an error.
bool run(const PngJob& job) {
    png_structp png = png_create_write_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
        [](png_structp, png_const_charp) {});
    if (!png) return false;
    png_infop info = png_create_info_struct(png);
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, nullptr);
        return false;
    }
    png_init_io(png, job.file);
    // The format allows 2^31 - 1; libpng's own default limit is lower than ours.
    png_set_user_limits(png, 0x7fffffffu, 0x7fffffffu);
    png_set_IHDR(png, info, job.width, job.height, 8, job.color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    // The noisier the picture the larger the file of the quick way, compared with the defaults.
    const bool quick = job.effort == PngEffort::quick;
    png_set_compression_level(png, quick ? 3 : 6);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, quick ? PNG_FILTER_SUB : PNG_ALL_FILTERS);
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (job.text_count > 0) png_set_text(png, info, job.texts, job.text_count);
    png_write_info(png, info);
    png_write_image(png, job.rows);
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return true;
}

/// False if libpng or the stream reported an error.
bool writeTo(std::FILE* file, int width, int height, const std::vector<std::uint8_t>& given,
             const std::map<std::string, std::string>& metadata, PngEffort effort) {
    const std::size_t area =
        width < 1 || height < 1 ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (area == 0 || (given.size() != 3 * area && given.size() != 4 * area))
        throw std::invalid_argument(
            fmt::format("{} bytes are no RGB or RGBA picture of {} x {}", given.size(), width, height));
    const bool alpha = given.size() == 4 * area;
    const std::size_t stride = (alpha ? 4 : 3) * static_cast<std::size_t>(width);
    // libpng takes pointers to non-const, but doesn't write to them.
    std::vector<std::uint8_t> pixels = given;
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) rows.push_back(pixels.data() + y * stride);
    std::map<std::string, std::string> strings = metadata;
    std::vector<std::string> keywords;
    std::vector<png_text> texts;
    for (const auto& entry : strings) {
        checkKeyword(entry.first);
        keywords.push_back(entry.first);
    }
    std::size_t index = 0;
    for (auto& entry : strings) {
        std::string& value = entry.second;
        const bool ascii = std::all_of(value.begin(), value.end(), [](unsigned char c) { return c < 128; });
        png_text text{};
        text.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        text.key = keywords[index++].data();
        text.text = value.data();
        text.text_length = ascii ? value.size() : 0;
        text.itxt_length = ascii ? 0 : value.size();
        texts.push_back(text);
    }

    const PngJob job{file,
                     static_cast<png_uint_32>(width),
                     static_cast<png_uint_32>(height),
                     rows.data(),
                     texts.data(),
                     static_cast<int>(texts.size()),
                     effort,
                     alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB};
    errno = 0;
    return run(job) && std::fflush(file) == 0;
}

}  // namespace

void writePng(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels,
              const std::map<std::string, std::string>& metadata) {
    const File file(std::fopen(path.c_str(), "wb"));
    if (!file) throw OutputError(fmt::format("{}: can't be written ({})", path.string(), std::strerror(errno)));
    if (!writeTo(file.get(), width, height, pixels, metadata, PngEffort::quick))
        throw writeError(path.string(), errno ? std::strerror(errno) : "libpng failed");
}

std::vector<std::uint8_t> encodePng(int width, int height, const std::vector<std::uint8_t>& pixels,
                                    const std::map<std::string, std::string>& metadata, PngEffort effort) {
    char* bytes = nullptr;
    std::size_t size = 0;
    File file(open_memstream(&bytes, &size));
    if (!file) throw std::bad_alloc();
    const bool written = writeTo(file.get(), width, height, pixels, metadata, effort);
    file.reset();  // sets `bytes`
    const std::unique_ptr<char, decltype(&std::free)> owner(bytes, &std::free);
    if (!written || !bytes) throw std::bad_alloc();
    return {bytes, bytes + size};
}

}  // namespace stratum::shade
