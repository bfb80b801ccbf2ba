// Films that the system's ffmpeg encodes: .mp4 (H.264), .webm (VP9), .gif.
#pragma once

#include "animate/encode/child_process.h"
#include "animate/encode/film_file.h"
#include "base/atomic_file.h"

#include <memory>
#include <string>

namespace stratum::animate {

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
