#include "shade/film/exr.h"

#include "base/byte_cursor.h"
#include "base/error.h"
#include "base/input_file.h"
#include "shade/film/exr_bytes.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
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

namespace {

std::map<std::string, std::string> attributesOf(const Imf::Header& header) {
    std::map<std::string, std::string> result;
    for (auto i = header.begin(); i != header.end(); ++i) {
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
            result[i.name()] = text->value();
        if (const auto* n = dynamic_cast<const Imf::IntAttribute*>(&i.attribute()))
            result[i.name()] = std::to_string(n->value());
        if (const auto* x = dynamic_cast<const Imf::FloatAttribute*>(&i.attribute()))
            result[i.name()] = fmt::format("{}", x->value());
    }
    return result;
}

Primaries primariesOf(const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& stated = Imf::chromaticities(header);
    const auto at = [](const Imath::V2f& place) { return glm::dvec2(place.x, place.y); };
    return {at(stated.red), at(stated.green), at(stated.blue), at(stated.white)};
}

ExrImage read(std::string_view bytes, const std::filesystem::path& path, std::size_t most) {
    ExrBytes stream(bytes, path.string());
    Imf::InputFile file(stream, 1);
    const Imath::Box2i window = file.header().dataWindow();
    const auto width = static_cast<std::int64_t>(window.max.x) - window.min.x + 1;
    const auto height = static_cast<std::int64_t>(window.max.y) - window.min.y + 1;
    if (width < 1 || height < 1 || static_cast<std::uint64_t>(width) > most / static_cast<std::uint64_t>(height))
        throw InputError(fmt::format("{}: {} x {} pixels; at most {} can be read. Scale it down", path.string(), width,
                                     height, most));
    const Imf::ChannelList& channels = file.header().channels();
    const bool color = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!color && !channels.findChannel("Y"))
        throw InputError(fmt::format("{}: has neither channels R, G, B nor Y", path.string()));
    for (const char* name : {"R", "G", "B", "Y"}) {
        const Imf::Channel* channel = channels.findChannel(name);
        if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
            throw InputError(
                fmt::format("{}: channel {} is subsampled; save it at full resolution", path.string(), name));
    }

    ExrImage image{
        static_cast<int>(width), static_cast<int>(height), {}, attributesOf(file.header()), primariesOf(file.header())};
    image.rgb.resize(static_cast<std::size_t>(width * height));
    const std::array<const char*, 3> names = {color ? "R" : "Y", "G", "B"};
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < (color ? 3u : 1u); ++c)
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &image.rgb[0][static_cast<int>(c)], window, sizeof(Color),
                                                 sizeof(Color) * static_cast<std::size_t>(width)));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    if (!color)
        for (Color& p : image.rgb) p = Color(p.r);
    return image;
}

}  // namespace

bool isExr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

ExrImage readExr(const std::filesystem::path& path, std::size_t most) {
    const InputFile input(path);
    checkExrHeader(input.bytes(), most, path.string());
    try {
        return read(input.bytes(), path, most);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: can't be read as OpenEXR ({}); copy or save it again", path.string(), error.what()));
    }
}

Imf::FrameBuffer exrBufferOf(const Film& film) {
    constexpr std::size_t kChannels = 4;
    constexpr std::array<const char*, kChannels> kNames = {"R", "G", "B", "A"};
    static_assert(sizeof(Pixel) == kChannels * sizeof(float) && std::is_standard_layout_v<Pixel>);
    const PixelBox& region = film.region();
    // Inclusive corners. OpenEXR addresses pixels by frame coordinates: its base is where (0, 0) would be.
    const Imath::Box2i place(Imath::V2i(region.x0, region.y0), Imath::V2i(region.x1 - 1, region.y1 - 1));
    const auto row = static_cast<std::size_t>(film.width());
    auto* const pixels = reinterpret_cast<float*>(const_cast<Pixel*>(film.pixels().data()));
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < kChannels; ++c)
        buffer.insert(kNames[c], Imf::Slice::Make(Imf::FLOAT, pixels + c, place, sizeof(Pixel), sizeof(Pixel) * row));
    for (const FilmLayer& layer : film.layers()) {
        const std::size_t pixel = sizeof(float) * layer.channels.size();
        for (std::size_t c = 0; c < layer.channels.size(); ++c)
            buffer.insert(
                layer.name + "." + layer.channels[c],
                Imf::Slice::Make(Imf::FLOAT, const_cast<float*>(layer.values.data()) + c, place, pixel, pixel * row));
    }
    return buffer;
}

void writeExr(const std::filesystem::path& path, const Film& film, const std::map<std::string, std::string>& metadata) {
    const PixelBox& region = film.region();
    // Inclusive corners.
    const Imath::Box2i display(Imath::V2i(0, 0), Imath::V2i(film.frameWidth() - 1, film.frameHeight() - 1));
    const Imath::Box2i data(Imath::V2i(region.x0, region.y0), Imath::V2i(region.x1 - 1, region.y1 - 1));
    Imf::Header header(display, data, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    Imf::addChromaticities(header, Imf::Chromaticities());
    for (const auto& [name, text] : metadata) {
        if (name.empty() || header.find(name.c_str()) != header.end() || name == "channels")
            throw std::invalid_argument(fmt::format("'{}' can't be the name of an EXR attribute of ours", name));
        header.insert(name.c_str(), Imf::StringAttribute(text));
    }
    const Imf::FrameBuffer buffer = exrBufferOf(film);
    for (auto i = buffer.begin(); i != buffer.end(); ++i)
        header.channels().insert(i.name(), Imf::Channel(i.slice().type));
    try {
        // The bytes don't depend on the number of threads.
        const auto threads =
            static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
        Imf::OutputFile file(path.c_str(), header, threads);
        file.setFrameBuffer(buffer);
        file.writePixels(film.height());
    } catch (const std::exception& error) {
        throw writeError(path.string(), error.what());
    }
}

}  // namespace stratum::shade
