// Memory for many short pieces of bytes that are forgotten together.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::exporter {

/// Pieces stay where they are until clear(), which keeps the memory for the next ones: fresh pages are slow, and
/// vectors that double take twice what they hold.
class ByteArena {
public:
    std::string_view keep(std::span<const char> piece) {
        if (piece.size() > kChunk - used_) next();
        char* const at = chunks_[current_ - 1].get() + used_;
        std::memcpy(at, piece.data(), piece.size());
        used_ += piece.size();
        return {at, piece.size()};
    }
    void clear() {
        current_ = 0;
        used_ = kChunk;
    }
    /// The largest piece.
    static constexpr std::size_t kChunk = std::size_t{1} << 18;

private:
    void next() {
        if (current_ == chunks_.size()) chunks_.push_back(std::make_unique_for_overwrite<char[]>(kChunk));
        ++current_;
        used_ = 0;
    }

    std::vector<std::unique_ptr<char[]>> chunks_;
    std::size_t current_ = 0;    // chunks in use
    std::size_t used_ = kChunk;  // bytes of the last of them
};

}  // namespace stratum::exporter
