#include "animate/encode/apng_writer.h"

#include "base/big_endian.h"
#include "base/checksum.h"
#include "base/error.h"
#include "shade/film/png.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace stratum::animate {
namespace {

constexpr std::size_t kSignatureBytes = 8;

void append16(std::string& bytes, std::uint32_t value) {
    bytes.push_back(static_cast<char>(value >> 8 & 0xff));
    bytes.push_back(static_cast<char>(value & 0xff));
}

struct Chunk {
    std::string_view type, data;
};

// Of a file that libpng has just written.
std::vector<Chunk> chunksOf(std::string_view png) {
    std::vector<Chunk> chunks;
    for (std::size_t at = kSignatureBytes; at + 12 <= png.size();) {
        const std::size_t length = bigEndian32(png, at);
        chunks.push_back({png.substr(at + 4, 4), png.substr(at + 8, length)});
        at += 12 + length;
    }
    return chunks;
}

std::string_view textOf(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ApngWriter::ApngWriter(const std::filesystem::path& path, FilmFormat format)
    : format_(std::move(format)), file_(path), out_(file_.temporary(), std::ios::binary) {}

void ApngWriter::writeChunk(std::string_view type, std::string_view data) {
    std::string head;
    appendBigEndian32(head, static_cast<std::uint32_t>(data.size()));
    head += type;
    std::string tail;
    // The sum of no bytes would begin anew.
    appendBigEndian32(tail, data.empty() ? checksumOf(type) : checksumOf(data, checksumOf(type)));
    out_.write(head.data(), static_cast<std::streamsize>(head.size()));
    out_.write(data.data(), static_cast<std::streamsize>(data.size()));
    out_.write(tail.data(), static_cast<std::streamsize>(tail.size()));
    if (!out_) throw writeError(file_.destination().string(), errno != 0 ? std::strerror(errno) : "unknown error");
}

void ApngWriter::writeControl(const Rectangle& at) {
    constexpr char kLeave = 0;    // what is drawn stays for the next frame
    constexpr char kReplace = 0;  // and is not blended
    std::string data;
    for (const std::uint32_t value : {sequence_++, at.width, at.height, at.x, at.y}) appendBigEndian32(data, value);
    const FrameRatio ratio = ratioOf(format_.rate);
    append16(data, static_cast<std::uint32_t>(ratio.seconds));
    append16(data, static_cast<std::uint32_t>(ratio.frames));
    data.push_back(kLeave);
    data.push_back(kReplace);
    writeChunk("fcTL", data);
}

ApngWriter::Rectangle ApngWriter::changed(const std::vector<std::uint8_t>& rgb) const {
    const auto width = static_cast<std::size_t>(format_.width);
    const auto height = static_cast<std::size_t>(format_.height);
    std::size_t x0 = width;
    std::size_t x1 = 0;
    std::size_t y0 = height;
    std::size_t y1 = 0;
    for (std::size_t y = 0; y < height; ++y) {
        const auto row = rgb.begin() + static_cast<std::ptrdiff_t>(3 * width * y);
        const auto row_end = row + static_cast<std::ptrdiff_t>(3 * width);
        const auto old = last_.begin() + (row - rgb.begin());
        const auto first = std::mismatch(row, row_end, old).first;
        if (first == row_end) continue;
        const auto last = std::mismatch(std::make_reverse_iterator(row_end), std::make_reverse_iterator(row),
                                        std::make_reverse_iterator(old + (row_end - row)))
                              .first.base();
        x0 = std::min(x0, static_cast<std::size_t>(first - row) / 3);
        x1 = std::max(x1, static_cast<std::size_t>(last - row + 2) / 3);
        y0 = std::min(y0, y);
        y1 = y + 1;
    }
    if (x1 <= x0) return {0, 0, 1, 1};  // a frame has one pixel at least
    return {static_cast<std::uint32_t>(x0), static_cast<std::uint32_t>(y0), static_cast<std::uint32_t>(x1 - x0),
            static_cast<std::uint32_t>(y1 - y0)};
}

void ApngWriter::addFirst(const std::vector<std::uint8_t>& rgb) {
    const auto png = shade::encodePng(format_.width, format_.height, rgb, format_.metadata, shade::PngEffort::small);
    out_.write(reinterpret_cast<const char*>(png.data()), kSignatureBytes);
    bool picture = false;
    for (const Chunk& chunk : chunksOf(textOf(png))) {
        if (chunk.type == "IEND") break;
        if (chunk.type == "IDAT" && !std::exchange(picture, true))
            writeControl({0, 0, static_cast<std::uint32_t>(format_.width), static_cast<std::uint32_t>(format_.height)});
        writeChunk(chunk.type, chunk.data);
        if (chunk.type != "IHDR") continue;
        std::string control;
        appendBigEndian32(control, static_cast<std::uint32_t>(format_.frames));
        appendBigEndian32(control, 0);  // plays: for ever
        writeChunk("acTL", control);
    }
}

void ApngWriter::add(const std::vector<std::uint8_t>& rgb) {
    if (added_ == format_.frames ||
        rgb.size() != 3 * static_cast<std::size_t>(format_.width) * static_cast<std::size_t>(format_.height))
        throw std::logic_error("a frame of an animated PNG too many, or of another size");
    if (added_++ == 0) {
        addFirst(rgb);
        last_ = rgb;
        return;
    }
    const Rectangle at = changed(rgb);
    std::vector<std::uint8_t> part;
    part.reserve(std::size_t{3} * at.width * at.height);
    for (std::uint32_t y = at.y; y < at.y + at.height; ++y) {
        const auto row = rgb.begin() + static_cast<std::ptrdiff_t>(
                                           3 * (std::size_t{y} * static_cast<std::size_t>(format_.width) + at.x));
        part.insert(part.end(), row, row + static_cast<std::ptrdiff_t>(std::size_t{3} * at.width));
    }
    const auto png =
        shade::encodePng(static_cast<int>(at.width), static_cast<int>(at.height), part, {}, shade::PngEffort::small);
    writeControl(at);
    std::string data;
    appendBigEndian32(data, sequence_++);
    for (const Chunk& chunk : chunksOf(textOf(png)))
        if (chunk.type == "IDAT") data += chunk.data;
    writeChunk("fdAT", data);
    last_ = rgb;
}

void ApngWriter::finish() {
    if (added_ != format_.frames) throw std::logic_error("an animated PNG has fewer frames than it says");
    writeChunk("IEND", {});
    out_.close();
    if (!out_) throw writeError(file_.destination().string());
    file_.commit();
}

}  // namespace stratum::animate
