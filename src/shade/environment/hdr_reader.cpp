#include "shade/environment/hdr_reader.h"

#include "base/error.h"
#include "shade/primaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

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
    glm::dvec3 exposure{1.0};  // texels were multiplied by this
    Primaries primaries;
    std::string_view size;  // the resolution line
};

/// As many numbers as there is room for, with spaces between. Throws InputError with `what` it is of which line.
void readNumbers(std::string_view text, std::span<double> numbers, std::string_view what, std::string_view line) {
    for (double& number : numbers) {
        while (text.starts_with(' ')) text.remove_prefix(1);
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc() || !std::isfinite(number)) throw InputError(fmt::format("{} is {}", line, what));
        text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    }
}

/// Takes one line of it.
void readLine(std::string_view line, std::string_view place, Header& header) {
    const auto rest = [&line](std::string_view key) {
        return line.starts_with(key) ? std::optional(line.substr(key.size())) : std::nullopt;
    };
    const std::string said = fmt::format("{}: {}", place, line.substr(0, 200));
    std::array<double, 8> n{};
    if (const auto text = rest("EXPOSURE=")) {
        readNumbers(*text, std::span(n).first(1), "no positive number", said);
        if (!(n[0] > 0.0)) throw InputError(fmt::format("{} is no positive number", said));
        header.exposure *= n[0];
    } else if (const auto correction = rest("COLORCORR=")) {
        readNumbers(*correction, std::span(n).first(3), "no three positive numbers", said);
        if (!(n[0] > 0.0 && n[1] > 0.0 && n[2] > 0.0))
            throw InputError(fmt::format("{} is no three positive numbers", said));
        header.exposure *= glm::dvec3(n[0], n[1], n[2]);
    } else if (const auto primaries = rest("PRIMARIES=")) {
        readNumbers(*primaries, n, "no eight numbers", said);
        header.primaries = {{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}};
    }
}

Header readHeader(std::string_view bytes, std::string_view name) {
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
        readLine(line, fmt::format("{}: line {}", name, line_number), header);
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
    const Color scale(1.0 / header.exposure);
    const std::size_t count = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    map.texels.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float* p = pixels.get() + 3 * i;
        map.texels[i] = Color(p[0], p[1], p[2]) * scale;
    }
    if (const auto matrix = toRec709(header.primaries)) convert(map.texels, *matrix);
    return map;
}

}  // namespace stratum::shade
