#include "animate/encode/film_file.h"

#include "animate/encode/apng_writer.h"
#include "animate/encode/ffmpeg_writer.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"

#include <fmt/format.h>

#include <cmath>

namespace stratum::animate {

FilmKind filmKindOf(const std::filesystem::path& path) {
    const std::string ending = lowerCase(path.extension().string());
    if (ending == ".mp4") return FilmKind::mp4;
    if (ending == ".webm") return FilmKind::webm;
    if (ending == ".gif") return FilmKind::gif;
    if (ending == ".png" || ending == ".apng") return FilmKind::apng;
    throw UsageError(
        fmt::format("--film {}: the name must end in .mp4, .webm, .gif or .png (an animated PNG)", path.string()));
}

int usualRate(FilmKind kind) { return kind == FilmKind::mp4 || kind == FilmKind::webm ? 30 : 20; }

FrameRatio ratioOf(double rate) {
    constexpr int kSlower = 1001;  // for each 1000 frames
    constexpr double kWritten = 0.005;
    for (const int whole : {24, 30, 60}) {
        const FrameRatio ratio{1000 * whole, kSlower};
        if (std::abs(rate - ratio.perSecond()) < kWritten) return ratio;
    }
    const double whole = std::round(rate);
    if (std::abs(rate - whole) < kWritten) return {static_cast<int>(whole), 1};
    return {static_cast<int>(std::round(100 * rate)), 100};
}

void requireFilm(const std::filesystem::path& path, const FilmFormat& format) {
    const FilmKind kind = filmKindOf(path);
    if (format.frames == 0)
        throw UsageError(fmt::format("--film {}: has no frames; give more --seconds or more --fps", path.string()));
    if (isStandardOutput(path))
        throw UsageError(fmt::format("--film {}: a film can't go to standard output; name a file", path.string()));
    const bool video = kind == FilmKind::mp4 || kind == FilmKind::webm;
    if (video && (format.width % 2 != 0 || format.height % 2 != 0))
        throw UsageError(fmt::format(
            "--film {}: {} x {} pixels: films of this kind have even sizes, since their colours are stored for 2 x 2 "
            "pixels; --size {}x{} or a --crop of it, or a .png or .gif",
            path.string(), format.width, format.height, format.width + format.width % 2,
            format.height + format.height % 2));
    const int most = kind == FilmKind::gif ? 50 : 240;
    if (format.rate < 1 || format.rate > most)
        throw UsageError(fmt::format("--fps {:g}: a film of this kind has 1 to {} frames a second", format.rate, most));
    if (kind != FilmKind::gif) return;
    // The palette is of all frames, which ffmpeg keeps until it has seen the last one.
    const double bytes = 3.0 * format.width * format.height * static_cast<double>(format.frames);
    requireMemory(bytes, fmt::format("--film {}: ffmpeg must keep all frames for its palette, which", path.string()),
                  "make a .mp4, or less --seconds, --fps or --size");
}

std::unique_ptr<FilmFile> makeFilmFile(const std::filesystem::path& path, const FilmFormat& format) {
    requireFilm(path, format);
    if (filmKindOf(path) == FilmKind::apng) return std::make_unique<ApngWriter>(path, format);
    return std::make_unique<FfmpegWriter>(path, format);
}

}  // namespace stratum::animate
