#include "shade/film/exr_header.h"

#include "base/byte_cursor.h"
#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

namespace stratum::shade {
namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::uint32_t kLongNames = 0x400, kDeep = 0x800, kParts = 0x1000;
constexpr std::uint64_t kMostSide = std::uint64_t{1} << 17;  // pixels
constexpr std::uint64_t kSmall = std::uint64_t{1} << 20;     // bytes that are always allowed
constexpr std::uint64_t kMostChannels = 1024;
constexpr int kMostParts = 256;

class Cursor : public ByteCursor<Cursor> {
public:
    Cursor(std::string_view bytes, std::string_view name) : ByteCursor(bytes), name_(name) {}

    [[noreturn]] void fail(std::string_view why) const {
        throw InputError(
            fmt::format("{}: can't be read as OpenEXR ({} about byte {}); copy or save it again", name_, why, offset_));
    }
    [[noreturn]] void endsEarly() const { fail("the header ends early"); }
    /// Reads up to and including a zero.
    std::string_view text(std::size_t most) {
        const std::size_t length = bytes_.substr(offset_, most + 1).find('\0');
        if (length == std::string_view::npos) fail("a name does not end");
        return take(length + 1).substr(0, length);
    }

private:
    std::string_view name_;
};

struct Part {
    std::optional<std::array<std::int32_t, 4>> window;  // least x, y, largest x, y
    std::uint64_t pixel_bytes = 0;
    std::uint64_t lines = 1;  // a chunk
    bool dwa = false;
    std::optional<std::array<std::uint32_t, 2>> tile;  // pixels
    std::int64_t chunks = 0;                           // as stated in the header
    bool deep = false;
};

std::uint64_t bytesOfPixel(Cursor channels, std::size_t longest) {
    std::uint64_t sum = 0;
    std::uint64_t count = 0;
    while (!channels.text(longest).empty()) {
        const auto kind = channels.read<std::uint32_t>();
        if (kind > 2) channels.fail("a channel of an unknown kind");
        sum += kind == 1 ? 2 : 4;
        (void)channels.take(4);  // linear or not
        for (int axis = 0; axis < 2; ++axis)
            if (channels.read<std::int32_t>() < 1) channels.fail("a channel without a sampling rate");
        if (++count > kMostChannels) channels.fail("more than 1024 channels");
    }
    if (!channels.done()) channels.fail("channels that end before their list");
    return sum;
}

/// Bytes of a value; nothing for types of variable length. OpenEXR ignores the stated length of types of fixed length.
std::optional<std::uint32_t> sizeOf(std::string_view kind) {
    constexpr std::array<std::pair<std::string_view, std::uint32_t>, 24> kSizes = {{
        {"box2f", 16},      {"box2i", 16},         {"chromaticities", 32},
        {"compression", 1}, {"deepImageState", 1}, {"double", 8},
        {"envmap", 1},      {"float", 4},          {"int", 4},
        {"keycode", 28},    {"lineOrder", 1},      {"m33d", 72},
        {"m33f", 36},       {"m44d", 128},         {"m44f", 64},
        {"rational", 8},    {"v2d", 16},           {"v2f", 8},
        {"v2i", 8},         {"v3d", 24},           {"v3f", 12},
        {"v3i", 12},        {"tiledesc", 9},       {"timecode", 8},
    }};
    for (const auto& [name, size] : kSizes)
        if (name == kind) return size;
    return std::nullopt;
}

/// False at the end of all headers.
bool readPart(Cursor& cursor, std::size_t longest, std::string_view name, Part& part) {
    for (bool first = true;; first = false) {
        const std::string_view key = cursor.text(longest);
        if (key.empty()) return !first;
        const std::string_view kind = cursor.text(longest);
        const auto size = cursor.read<std::uint32_t>();
        const std::string_view bytes = cursor.take(size);
        Cursor value(bytes, name);
        if (size != sizeOf(kind).value_or(size) || (kind == "floatvector" && size % 4 != 0))
            cursor.fail(fmt::format("{} of another size than its kind, {},", key, kind));
        // OpenEXR reads lists of channels and previews of any name.
        if (kind == "chlist") {
            const std::uint64_t pixel_bytes = bytesOfPixel(value, longest);
            if (key == "channels") part.pixel_bytes = pixel_bytes;
        } else if (key == "dataWindow") {
            part.window = value.read<std::array<std::int32_t, 4>>();
        } else if (key == "compression") {
            // None, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
            constexpr std::array<std::uint64_t, 10> kLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
            const auto compression = value.read<std::uint8_t>();
            if (compression >= kLines.size()) value.fail("a compression that is not known");
            part.lines = kLines[compression];
            part.dwa = compression >= 8;
        } else if (key == "tiles") {
            part.tile = value.read<std::array<std::uint32_t, 2>>();
        } else if (key == "chunkCount") {
            part.chunks = value.read<std::int32_t>();
        } else if (key == "type") {
            part.deep = bytes.starts_with("deep");
        } else if (kind == "preview") {
            const auto width = value.read<std::uint32_t>();
            const auto height = value.read<std::uint32_t>();
            if (std::uint64_t{width} * height != (size - 8) / 4 || size % 4 != 0)
                value.fail("a preview of another size than its data");
        }
    }
}

void check(const Part& part, std::size_t file_bytes, std::size_t most, const Cursor& cursor, std::string_view name) {
    if (part.deep) throw InputError(fmt::format("{}: holds deep data; save it as a flat picture", name));
    if (!part.window) cursor.fail("no data window");
    const auto& w = *part.window;
    const std::int64_t width = std::int64_t{w[2]} - w[0] + 1;
    const std::int64_t height = std::int64_t{w[3]} - w[1] + 1;
    constexpr std::int64_t kFarthest = std::int64_t{1} << 30;
    if (width < 1 || height < 1 || std::min(w[0], w[1]) < -kFarthest || std::max(w[2], w[3]) > kFarthest)
        cursor.fail("a data window without pixels");
    const auto columns = static_cast<std::uint64_t>(width);
    const auto rows = static_cast<std::uint64_t>(height);
    if (columns > kMostSide || rows > kMostSide || columns * rows > most)
        throw InputError(
            fmt::format("{}: {} x {} pixels; at most {} can be read. Scale it down", name, width, height, most));
    std::uint64_t pixels = columns * std::max(rows, part.lines);
    std::uint64_t chunks = (rows - 1) / part.lines + 1;
    if (part.tile) {
        const auto [x, y] = *part.tile;
        if (x < 1 || y < 1 || x > kMostSide || y > kMostSide) cursor.fail("tiles without a size");
        pixels = std::max(columns * rows, std::uint64_t{x} * y);
        chunks = ((columns - 1) / x + 1) * ((rows - 1) / y + 1);
    }
    constexpr std::uint64_t kPlace = 8;  // bytes, in the table of chunks
    if (chunks > file_bytes / kPlace || part.chunks < 0 ||
        static_cast<std::uint64_t>(part.chunks) > file_bytes / kPlace)
        cursor.fail("more chunks than there are bytes");
    const std::uint64_t packed = (part.dwa ? 65536 : 2048) * std::uint64_t{file_bytes};
    if (pixels * std::max<std::uint64_t>(part.pixel_bytes, 1) > std::max(kSmall, packed))
        cursor.fail(fmt::format("{} x {} pixels can't come from {} bytes", width, height, file_bytes));
}

}  // namespace

void checkExrHeader(std::string_view bytes, std::size_t most, std::string_view name) {
    Cursor cursor(bytes, name);
    (void)cursor.take(4);  // the magic number, see isExr()
    const auto version = cursor.read<std::uint32_t>();
    if ((version & 0xff) > 2) cursor.fail("a version that is not known");
    if ((version & kDeep) != 0) throw InputError(fmt::format("{}: holds deep data; save it as a flat picture", name));
    const std::size_t longest = (version & kLongNames) != 0 ? 255 : 31;
    for (int n = 0;; ++n) {
        Part part;
        if (!readPart(cursor, longest, name, part)) {
            if (n == 0) cursor.fail("no header");
            return;
        }
        check(part, bytes.size(), most, cursor, name);
        if ((version & kParts) == 0) return;
        if (n == kMostParts) cursor.fail("more than 256 parts");
    }
}

}  // namespace stratum::shade
