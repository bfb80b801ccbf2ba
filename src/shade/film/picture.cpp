#include "shade/film/picture.h"

#include "base/error.h"
#include "base/text.h"
#include "shade/film/exr_writer.h"
#include "shade/film/png_writer.h"

#include <fmt/format.h>

namespace stratum::shade {
namespace {

/// Whether the name says EXR; throws if it says neither kind.
bool isExr(const std::filesystem::path& path) {
    if (path == "-") return false;
    const std::string ending = lowerCase(path.extension().string());
    if (ending == ".exr") return true;
    if (ending == ".png") return false;
    throw UsageError(fmt::format("{}: the name must end in .png (to look at) or .exr (linear)", path.string()));
}

}  // namespace

PictureFile::PictureFile(const std::filesystem::path& path) : exr_(isExr(path)), file_(path) {}

void PictureFile::write(const Film& film, const Metadata& metadata, const ToneOptions& tone, const Legend* legend) {
    file_.write([&](const std::filesystem::path& to) {
        if (exr_) {
            writeExr(to, film, metadata);
            return;
        }
        std::vector<std::uint8_t> rgb = toDisplay(film, tone);
        if (legend) draw(*legend, film.width(), film.height(), rgb);
        writePng(to, film.width(), film.height(), rgb, metadata);
    });
}

}  // namespace stratum::shade
