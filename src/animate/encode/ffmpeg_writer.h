// Films that the system's ffmpeg encodes: .mp4 (H.264), .webm (VP9), .gif.
#pragma once

#include "animate/encode/film_file.h"
#include "base/atomic_file.h"

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::animate {

// Another program that reads what this one makes.

/// The program of that name in the folders of $PATH; nothing if there is none.
std::optional<std::filesystem::path> findProgram(std::string_view name);

/// A running program. This process writes to its standard input; its standard output is thrown away.
class ChildProcess {
public:
    /// Throws OutputError if it can't be started.
    ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
    /// Ends it, if it still runs.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Returns when the program has taken all bytes, or the system keeps them for it. False if it reads no more.
    bool send(std::span<const std::uint8_t> bytes) const;
    /// Ends its input, and waits until it has ended. "" if it did so with status 0; else how: "ended with status 1".
    std::string finish();
    /// The last of what it wrote to standard error, a line at most.
    std::string lastWords() const;

private:
    void closeInput();

    pid_t id_ = -1;
    int input_ = -1;   // our end of its standard input: a socket, whose errors are no signals
    int errors_ = -1;  // its standard error: a file without a name
};

/// Frames go to ffmpeg's standard input as they are; it encodes while the next one is made.
class FfmpegWriter final : public FilmFile {
public:
    /// Throws OutputError if there is no ffmpeg on $PATH, with what to do then.
    FfmpegWriter(const std::filesystem::path& path, const FilmFormat& format);
    void add(const std::vector<std::uint8_t>& rgb) override;
    void finish() override;

private:
    [[noreturn]] void fail(const std::string& how) const;

    std::size_t frames_, added_ = 0;
    std::filesystem::path program_;
    AtomicFile file_;
    std::unique_ptr<ChildProcess> ffmpeg_;
};

}  // namespace stratum::animate
