// Writes a film as a file: a viewable PNG or a linear EXR, by the name's ending.
#pragma once

#include "base/atomic_file.h"
#include "shade/film/film.h"
#include "shade/film/legend.h"
#include "shade/film/tonemap.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace stratum::shade {

/// Keyword -> text, written as PNG tEXt chunks or EXR string attributes.
/// Keywords: 1 to 79 printable Latin-1 characters (PNG's rule).
using Metadata = std::map<std::string, std::string>;

/// A picture file to be written. Construct it before rendering, so that a bad name fails at once.
class PictureFile {
public:
    /// Standard output: "-" (PNG), "-.exr". Throws UsageError for other names than *.png and *.exr, and OutputError.
    explicit PictureFile(const std::filesystem::path& path);
    /// Whether it keeps linear values and layers: an EXR.
    bool linear() const { return exr_; }
    /// Writes the picture and commits the file. `tone` is for PNG only. Throws OutputError.
    /// @param legend  drawn into a PNG's upper left corner, if given
    void write(const Film& film, const Metadata& metadata, const ToneOptions& tone = {},
               const Legend* legend = nullptr);
    /// Commits a file that `writer` writes under the name that it is given. Throws what it throws, and OutputError.
    void write(const std::function<void(const std::filesystem::path& to)>& writer) { file_.write(writer); }

private:
    bool exr_;
    AtomicFile file_;
};

}  // namespace stratum::shade
