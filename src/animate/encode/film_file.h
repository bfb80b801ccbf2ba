// A film as a file, of a kind that the name's ending says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace stratum::animate {

/// .png is an animated PNG, which this project writes itself; the others are made by ffmpeg.
enum class FilmKind : std::uint8_t { mp4, webm, gif, apng };

/// By its ending: .mp4, .webm, .gif, .png or .apng. Throws UsageError for others.
FilmKind filmKindOf(const std::filesystem::path& path);

/// Frames a second, unless others are asked for: 30; 20 of .gif and .png, whose frames are large.
int usualRate(FilmKind kind);

/// So many frames in so many seconds.
struct FrameRatio {
    int frames = 0, seconds = 0;
    double perSecond() const { return static_cast<double>(frames) / seconds; }
};

/// Of a rate as people write it: 23.976, 29.97 and 59.94 are 24000, 30000 and 60000 frames in 1001 s (SMPTE ST 12-1);
/// others have at most two decimals.
FrameRatio ratioOf(double rate);

struct FilmFormat {
    int width = 0, height = 0;  ///< pixels
    std::size_t frames = 0;     ///< that will be added
    double rate = 30;           ///< frames a second; see ratioOf()
    int threads = 0;            ///< of ffmpeg; 0: as it likes
    /// Keyword -> text, see shade::Metadata; in an animated PNG.
    std::map<std::string, std::string> metadata;
};

/// Throws UsageError for what this kind of film can't be: no frames, odd sizes of .mp4 and .webm, rates, more memory
/// than there is.
void requireFilm(const std::filesystem::path& path, const FilmFormat& format);

/// A film that is being written. The file gets its name when it is finished; without that, no new file is left, and an
/// old one stays.
class FilmFile {
public:
    FilmFile() = default;
    virtual ~FilmFile() = default;
    FilmFile(const FilmFile&) = delete;
    FilmFile& operator=(const FilmFile&) = delete;
    /// The next frame: 8-bit sRGB, row by row from the top. Throws OutputError.
    virtual void add(const std::vector<std::uint8_t>& rgb) = 0;
    /// After the last frame. Throws OutputError.
    virtual void finish() = 0;
};

/// Begins a film. Throws UsageError, see requireFilm(), and OutputError: a folder that is missing, no ffmpeg.
std::unique_ptr<FilmFile> makeFilmFile(const std::filesystem::path& path, const FilmFormat& format);

}  // namespace stratum::animate
