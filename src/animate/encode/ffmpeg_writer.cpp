#include "animate/encode/ffmpeg_writer.h"

#include "base/error.h"
#include "base/own_file.h"
#include "base/text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <system_error>

namespace stratum::animate {

std::optional<std::filesystem::path> findProgram(std::string_view name) {
    const char* path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nobody sets it
    for (const std::string_view folder : splitList(path != nullptr ? path : "", ':')) {
        std::filesystem::path program = std::filesystem::path(folder.empty() ? "." : folder) / name;
        std::error_code missing;
        if (std::filesystem::is_regular_file(program, missing) && ::access(program.c_str(), X_OK) == 0) return program;
    }
    return std::nullopt;
}

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
    std::array<int, 2> ends{-1, -1};
    const bool connected = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0;
    errors_ = ::memfd_create("errors", MFD_CLOEXEC);
    input_ = ends[0];
    int failure = connected && errors_ >= 0 ? 0 : errno;
    if (failure == 0) {
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, errors_, STDERR_FILENO);
        // As a program that a shell starts has them, whatever this one does about signals.
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
        std::vector<std::string> words{program.filename().string()};
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> pointers;
        pointers.reserve(words.size() + 1);
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        failure = ::posix_spawn(&id_, program.c_str(), &actions, &attributes, pointers.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
    if (ends[1] >= 0) ::close(ends[1]);
    if (failure == 0) return;
    id_ = -1;
    closeInput();
    if (errors_ >= 0) ::close(errors_);
    throw OutputError(fmt::format("{}: can't be started ({})", program.string(), std::strerror(failure)));
}

ChildProcess::~ChildProcess() {
    if (id_ > 0) {
        ::kill(id_, SIGKILL);
        (void)finish();
    }
    closeInput();
    ::close(errors_);
}

void ChildProcess::closeInput() {
    if (input_ >= 0) ::close(input_);
    input_ = -1;
}

bool ChildProcess::send(std::span<const std::uint8_t> bytes) const {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
    return true;
}

std::string ChildProcess::finish() {
    closeInput();
    int status = 0;
    while (id_ > 0 && ::waitpid(id_, &status, 0) < 0 && errno == EINTR) continue;
    id_ = -1;
    if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
    const int code = WEXITSTATUS(status);
    return code == 0 ? std::string() : fmt::format("ended with status {}", code);
}

std::string ChildProcess::lastWords() const {
    struct stat status {};
    if (::fstat(errors_, &status) != 0) return {};
    std::array<char, 1024> buffer{};
    const off_t from = std::max<off_t>(0, status.st_size - static_cast<off_t>(buffer.size()));
    const ssize_t got = ::pread(errors_, buffer.data(), buffer.size(), from);
    std::string text(buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' ')) text.pop_back();
    const std::size_t line = text.find_last_of("\n\r");
    return line == std::string::npos ? text : text.substr(line + 1);
}

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
    const FrameRatio ratio = ratioOf(format.rate);
    append(words, {"-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"});
    const std::vector<std::string> input{"-video_size", fmt::format("{}x{}", format.width, format.height),
                                         "-framerate",  fmt::format("{}/{}", ratio.frames, ratio.seconds),
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
