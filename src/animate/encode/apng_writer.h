// Animated PNG.
//
// Source: Portable Network Graphics (PNG) Specification, third edition, W3C 2025: 4.9 (frames), 11.3.6 (acTL, fcTL,
// fdAT).
#pragma once

#include "animate/encode/film_file.h"
#include "base/atomic_file.h"

#include <cstdint>
#include <fstream>
#include <string_view>
#include <vector>

namespace stratum::animate {

/// Plays forever. The first frame is the whole picture, which programs without animation show; of each other one only
/// the rectangle that differs from the frame before. The same frames give the same bytes.
class ApngWriter final : public FilmFile {
public:
    /// Throws OutputError.
    ApngWriter(const std::filesystem::path& path, FilmFormat format);
    /// As many as FilmFormat::frames.
    void add(const std::vector<std::uint8_t>& rgb) override;
    void finish() override;

private:
    struct Rectangle {
        std::uint32_t x = 0, y = 0, width = 0, height = 0;
    };

    Rectangle changed(const std::vector<std::uint8_t>& rgb) const;
    void addFirst(const std::vector<std::uint8_t>& rgb);
    void writeControl(const Rectangle& at);
    void writeChunk(std::string_view type, std::string_view data);

    FilmFormat format_;
    AtomicFile file_;
    std::ofstream out_;
    std::vector<std::uint8_t> last_;  // the frame before
    std::size_t added_ = 0;
    std::uint32_t sequence_ = 0;  // of fcTL and fdAT, together
};

}  // namespace stratum::animate
