// The values of a node's tiles: nearly always the background, outside and inside.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::march {

/// Of one or two different values a bit a tile is kept, or nothing; else all.
class TileValues {
public:
    TileValues() = default;
    explicit TileValues(std::span<const float> values) {
        if (values.empty()) return;
        one_ = other_ = values.front();
        for (const float value : values) {
            if (same(value, one_) || same(value, other_)) continue;
            if (!same(one_, other_)) {
                all_.assign(values.begin(), values.end());
                return;
            }
            other_ = value;
        }
        if (same(one_, other_)) return;
        others_.resize((values.size() + 63) / 64);
        for (std::size_t n = 0; n < values.size(); ++n)
            if (same(values[n], other_)) others_[n / 64] |= std::uint64_t{1} << (n % 64);
    }

    float operator[](std::size_t tile) const {
        if (!all_.empty()) return all_[tile];
        return !others_.empty() && (others_[tile / 64] >> (tile % 64) & 1) != 0 ? other_ : one_;
    }
    std::size_t bytes() const {
        return sizeof(*this) + all_.capacity() * sizeof(float) + others_.capacity() * sizeof(std::uint64_t);
    }

private:
    static bool same(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

    float one_ = 0, other_ = 0;
    std::vector<std::uint64_t> others_;  // a bit for each tile that has the other value
    std::vector<float> all_;
};

}  // namespace stratum::march
