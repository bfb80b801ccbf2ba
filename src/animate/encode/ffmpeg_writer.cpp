#include "animate/encode/ffmpeg_writer.h"

#include "base/error.h"
#include "base/own_file.h"

#include <fmt/format.h>

#include <fstream>
#include <initializer_list>
#include <utility>

namespace stratum::animate {
namespace {

void append(std::vector<std::string>& words, std::initializer_list<const char*> more) {
    words.insert(words.end(), more.begin(), more.end());
}

// From sRGB to the video of television, which players expect where a file doesn't say otherwise.
void appendColors(std::vector<std::string>& words) {
    append(words, {"-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd", "-pix_fmt", "yuv420p",
                   "-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"});
}

// Of all frames, which are kept until it is known.
constexpr const char* kOnePalette =
    "[0:v]split[frames][seen];[seen]palettegen=stats_mode=full[palette];"
    "[frames][palette]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle";

std::vector<std::string> argumentsOf(FilmKind kind, const FilmFormat& format, const std::string& output) {
    std::vector<std::string> words;
    append(words, {"-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"});
    const std::vector<std::string> input{"-video_size", fmt::format("{}x{}", format.width, format.height),
                                         "-framerate",  std::to_string(format.rate),
                                         "-i",          "pipe:0"};
    words.insert(words.end(), input.begin(), input.end());
    switch (kind) {
        case FilmKind::webm:
            appendColors(words);
            append(words, {"-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-deadline", "good", "-cpu-used", "4",
                           "-row-mt", "1", "-f", "webm"});
            break;
        case FilmKind::gif:
            append(words, {"-filter_complex", kOnePalette, "-loop", "0", "-f", "gif"});
            break;
        default:
            appendColors(words);
            append(words,
                   {"-c:v", "libx264", "-preset", "medium", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"});
    }
    words.emplace_back("-metadata");
    words.push_back(fmt::format("comment=by {}", kProgramMark));
    if (format.threads > 0) {
        words.emplace_back("-threads");
        words.push_back(std::to_string(format.threads));
    }
    words.push_back(output);
    return words;
}

// ffmpeg gives a GIF no comment: a block before the last byte.
void markGif(const std::filesystem::path& path) {
    const std::string text = fmt::format("by {}", kProgramMark);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(-1, std::ios::end);
    file << "\x21\xfe" << static_cast<char>(text.size()) << text << '\0' << ';';
    file.close();
    if (!file) throw writeError(path.string());
}

std::filesystem::path ffmpegFor(const std::filesystem::path& film) {
    if (auto program = findProgram("ffmpeg")) return *program;
    throw OutputError(
        fmt::format("{}: needs ffmpeg, and there is none on PATH; install it (Debian: apt install "
                    "ffmpeg), or write an animated .png, which needs no other program",
                    film.string()));
}

}  // namespace

FfmpegWriter::FfmpegWriter(const std::filesystem::path& path, const FilmFormat& format)
    : frames_(format.frames), program_(ffmpegFor(path)), file_(path, AtomicFile::Making::named) {
    const std::filesystem::path part = std::filesystem::absolute(file_.temporary());
    ffmpeg_ = std::make_unique<ChildProcess>(program_, argumentsOf(filmKindOf(path), format, part.string()));
}

void FfmpegWriter::fail(const std::string& how) const {
    const std::string words = ffmpeg_->lastWords();
    throw OutputError(fmt::format(
        "{}: ffmpeg {} after {} of {} frames{}; is the disk full, or is this ffmpeg made without the encoder?",
        file_.destination().string(), how, added_, frames_, words.empty() ? words : fmt::format(" ({})", words)));
}

void FfmpegWriter::add(const std::vector<std::uint8_t>& rgb) {
    if (ffmpeg_->send(rgb)) {
        ++added_;
        return;
    }
    const std::string how = ffmpeg_->finish();
    fail(how.empty() ? "read no more" : how);
}

void FfmpegWriter::finish() {
    const std::string how = ffmpeg_->finish();
    if (!how.empty()) fail(how);
    if (filmKindOf(file_.destination()) == FilmKind::gif) markGif(file_.temporary());
    file_.commit();
}

}  // namespace stratum::animate
