// A file with some of its bytes replaced, without a copy of the others.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::gcode {

/// The bytes of a file in pieces: views of the bytes that it was made from, which must outlive it, and new ones.
/// Movable, not copyable.
class PatchedBytes {
public:
    PatchedBytes() = default;
    PatchedBytes(PatchedBytes&&) = default;
    PatchedBytes& operator=(PatchedBytes&&) = default;
    PatchedBytes(const PatchedBytes&) = delete;
    PatchedBytes& operator=(const PatchedBytes&) = delete;

    /// Appends bytes that stay where they are.
    void keep(std::string_view bytes) {
        if (!bytes.empty()) pieces_.push_back(bytes);
    }
    /// Appends new ones.
    void add(std::string bytes) { keep(made_.emplace_back(std::move(bytes))); }

    const std::vector<std::string_view>& pieces() const { return pieces_; }
    std::size_t size() const {
        std::size_t sum = 0;
        for (const std::string_view piece : pieces_) sum += piece.size();
        return sum;
    }
    std::string text() const {
        std::string whole;
        whole.reserve(size());
        for (const std::string_view piece : pieces_) whole += piece;
        return whole;
    }

private:
    std::vector<std::string_view> pieces_;
    std::deque<std::string> made_;
};

}  // namespace stratum::gcode
