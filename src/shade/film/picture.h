// Writes a film as a file, of a kind that the name's ending says: pictures to look at, or a linear EXR.
#pragma once

#include "base/atomic_file.h"
#include "shade/film/film.h"
#include "shade/film/legend.h"
#include "shade/film/tonemap.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace stratum::shade {

/// Keyword -> text, written as PNG tEXt chunks, comments of a JPEG or EXR string attributes; not in WebP.
/// Keywords: 1 to 79 printable Latin-1 characters (PNG's rule).
using Metadata = std::map<std::string, std::string>;

enum class PictureKind : std::uint8_t { exr, png, jpeg, webp };

/// By its ending, .exr, .png, .jpg or .jpeg, .webp; "-" is a PNG. Throws UsageError for others.
PictureKind pictureKindOf(const std::filesystem::path& path);

/// Throws UsageError if the kind has no alpha: a transparent film can't be written to it.
void requireAlpha(const std::filesystem::path& path);

/// Throws UsageError if the kind has no pictures so large.
void requirePictureSize(const std::filesystem::path& path, int width, int height);

/// The pixels of a picture to look at: 8-bit RGB, of a transparent film RGBA, row by row from the top.
/// @param legend  drawn into the upper left corner, if given
std::vector<std::uint8_t> displayPixels(const Film& film, const ToneOptions& tone, const Legend* legend);

/// A picture file to be written. Construct it before rendering, so that a bad name fails at once.
class PictureFile {
public:
    /// Standard output: "-" (PNG), "-.exr" and so on. Throws UsageError for names of no kind, and OutputError.
    explicit PictureFile(const std::filesystem::path& path);
    /// Whether it keeps linear values and layers: an EXR.
    bool linear() const { return kind_ == PictureKind::exr; }
    /// Writes the picture and commits the file. `tone` is for pictures to look at. A transparent film keeps its alpha
    /// (requireAlpha()). Throws OutputError.
    /// @param legend  drawn into the upper left corner of such a picture, if given; not into transparent ones
    void write(const Film& film, const Metadata& metadata, const ToneOptions& tone = {},
               const Legend* legend = nullptr);

private:
    PictureKind kind_;
    AtomicFile file_;
};

}  // namespace stratum::shade
