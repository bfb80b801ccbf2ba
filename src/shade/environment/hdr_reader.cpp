#include "shade/environment/hdr_reader.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace stratum::shade {
namespace {

/// Feeds the decoder and detects reads past the end. With zeros the decoder would never stop, because runs of length 0
/// make no progress; so past the end it gets runs of the largest length, which soon exceed a row.
struct Feed {
    std::string_view bytes;
    std::size_t position = 0;
    bool starved = false;

    static int read(void* user, char* data, int size) {
        auto& feed = *static_cast<Feed*>(user);
        const std::size_t count = std::min(static_cast<std::size_t>(size), feed.bytes.size() - feed.position);
        if (count == 0 && size > 0) {
            feed.starved = true;
            std::memset(data, 0xff, static_cast<std::size_t>(size));
            return size;
        }
        std::memcpy(data, feed.bytes.data() + feed.position, count);
        feed.position += count;
        return static_cast<int>(count);
    }
    static void skip(void* user, int count) {
        auto& feed = *static_cast<Feed*>(user);
        // A negative count gives bytes back.
        const auto target = static_cast<std::ptrdiff_t>(feed.position) + count;
        feed.position = static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(target, 0, static_cast<std::ptrdiff_t>(feed.bytes.size())));
    }
    static int eof(void* user) {
        const auto& feed = *static_cast<Feed*>(user);
        return feed.position >= feed.bytes.size();
    }
};

struct Header {
    double exposure = 1.0;  // texels were multiplied by this
    std::string_view size;  // the resolution line
};

Header readHeader(std::string_view bytes, std::string_view name) {
    constexpr std::string_view kExposure = "EXPOSURE=";
    Header header;
    int line_number = 0;
    for (;;) {
        const std::size_t end = bytes.find('\n');
        ++line_number;
        if (end > 4096 || line_number > 1000)  // also where there is no end
            throw InputError(
                fmt::format("{}: line {}: the header does not end; the file is damaged", name, line_number));
        std::string_view line = bytes.substr(0, end);
        bytes.remove_prefix(end + 1);
        if (line.empty()) break;
        if (!line.starts_with(kExposure)) continue;
        line.remove_prefix(kExposure.size());
        while (line.starts_with(' ')) line.remove_prefix(1);
        double value = 0.0;
        const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), value);
        if (error != std::errc() || !(value > 0.0) || stop == line.data())
            throw InputError(fmt::format("{}: line {}: EXPOSURE={} is no positive number", name, line_number, line));
        header.exposure *= value;
    }
    header.size = bytes.substr(0, bytes.find('\n'));
    return header;
}

/// What so many texels take at least, packed as well as run lengths can.
std::size_t leastBytes(int width, int height) {
    constexpr std::size_t kLongestRun = 127;
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    // Rows that are too short or too long for run lengths are stored uncompressed.
    if (width < 8 || width >= 32768) return 4 * columns * rows;
    // A mark a row, and a run of two bytes a channel.
    constexpr std::size_t kRunOfAll = 8;
    return rows * (4 + kRunOfAll * ((columns + kLongestRun - 1) / kLongestRun));
}

}  // namespace

bool isHdr(std::string_view bytes) { return bytes.starts_with("#?RADIANCE") || bytes.starts_with("#?RGBE"); }

LightMap readHdr(std::string_view bytes, std::string_view name) {
    const Header header = readHeader(bytes, name);
    const stbi_io_callbacks callbacks{Feed::read, Feed::skip, Feed::eof};
    // The size first, so that an impossible one is refused before memory is allocated.
    LightMap map;
    Feed feed{bytes};
    int channels = 0;
    if (!stbi_info_from_callbacks(&callbacks, &feed, &map.width, &map.height, &channels))
        throw InputError(
            fmt::format("{}: '{}' can't be read ({}); expected 32-bit_rle_rgbe, rows from the top, e.g. -Y 512 +X 1024",
                        name, header.size.substr(0, 40), stbi_failure_reason()));
    if (map.width < 1 || map.height < 1 ||
        static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height) > kMostMapTexels)
        throw InputError(fmt::format("{}: {} x {} texels; at most {} can be read. Scale it down", name, map.width,
                                     map.height, kMostMapTexels));
    if (bytes.size() < leastBytes(map.width, map.height))
        throw InputError(fmt::format("{}: {} x {} texels can't come from {} bytes; copy or download it again", name,
                                     map.width, map.height, bytes.size()));
    feed = Feed{bytes};
    const std::unique_ptr<float, decltype(&stbi_image_free)> pixels(
        stbi_loadf_from_callbacks(&callbacks, &feed, &map.width, &map.height, &channels, 3), &stbi_image_free);
    if (feed.starved)
        throw InputError(fmt::format("{}: ends in the middle of its {} x {} texels; copy or download it again", name,
                                     map.width, map.height));
    if (!pixels) throw InputError(fmt::format("{}: can't be decoded ({})", name, stbi_failure_reason()));
    const auto scale = static_cast<float>(1.0 / header.exposure);
    const std::size_t count = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    map.texels.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float* p = pixels.get() + 3 * i;
        map.texels[i] = Color(p[0], p[1], p[2]) * scale;
    }
    return map;
}

}  // namespace stratum::shade
