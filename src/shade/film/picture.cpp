#include "shade/film/picture.h"

#include "base/error.h"
#include "base/text.h"
#include "shade/film/exr.h"
#include "shade/film/lossy_writers.h"
#include "shade/film/png.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <vector>

namespace stratum::shade {
namespace {

// No loss that can be seen at the size of the screen.
constexpr int kJpegQuality = 92;
constexpr int kWebpQuality = 90;

void writeBytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
    errno = 0;
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw writeError(path.string(), errno != 0 ? std::strerror(errno) : "unknown error");
}

}  // namespace

PictureKind pictureKindOf(const std::filesystem::path& path) {
    if (path == "-") return PictureKind::png;
    const std::string ending = lowerCase(path.extension().string());
    if (ending == ".exr") return PictureKind::exr;
    if (ending == ".png") return PictureKind::png;
    if (ending == ".jpg" || ending == ".jpeg") return PictureKind::jpeg;
    if (ending == ".webp") return PictureKind::webp;
    throw UsageError(
        fmt::format("{}: the name must end in .png, .jpg or .webp (to look at), or .exr (linear)", path.string()));
}

void requirePictureSize(const std::filesystem::path& path, int width, int height) {
    const PictureKind kind = pictureKindOf(path);
    const int most = kind == PictureKind::jpeg   ? kJpegMostSide
                     : kind == PictureKind::webp ? kWebpMostSide
                                                 : std::numeric_limits<int>::max();
    if (std::max(width, height) > most)
        throw UsageError(fmt::format("{}: pictures of this kind have at most {} pixels a side, not {} x {}; use .png",
                                     path.string(), most, width, height));
}

std::vector<std::uint8_t> displayPixels(const Film& film, const ToneOptions& tone, const Legend* legend) {
    if (film.transparent()) return toDisplayWithAlpha(film, tone);
    std::vector<std::uint8_t> rgb = toDisplay(film, tone);
    if (legend) draw(*legend, film.width(), film.height(), rgb);
    return rgb;
}

void requireAlpha(const std::filesystem::path& path) {
    if (pictureKindOf(path) == PictureKind::jpeg)
        throw UsageError(
            fmt::format("--background none: {}: a JPEG has no alpha; write a .png, .webp or .exr", path.string()));
}

PictureFile::PictureFile(const std::filesystem::path& path) : kind_(pictureKindOf(path)), file_(path) {}

void PictureFile::write(const Film& film, const Metadata& metadata, const ToneOptions& tone, const Legend* legend) {
    if (film.transparent()) requireAlpha(file_.destination());
    file_.write([&](const std::filesystem::path& to) {
        const int width = film.width();
        const int height = film.height();
        if (linear()) {
            writeExr(to, film, metadata);
            return;
        }
        const std::vector<std::uint8_t> pixels = displayPixels(film, tone, legend);
        switch (kind_) {
            case PictureKind::jpeg:
                return writeBytes(to, encodeJpeg(width, height, pixels, kJpegQuality, metadata));
            case PictureKind::webp:
                return writeBytes(to, encodeWebp(width, height, pixels, kWebpQuality));
            case PictureKind::png:
            case PictureKind::exr:
                return writePng(to, width, height, pixels, metadata);
        }
    });
}

}  // namespace stratum::shade
