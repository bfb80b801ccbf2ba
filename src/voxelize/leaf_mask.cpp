#include "voxelize/leaf_mask.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

// Bits whose z is one of 0..7-n or n..7: what a shift by n along z may keep.
constexpr std::uint64_t lowZ(int n) { return 0x0101010101010101u * (0xffu >> n); }
constexpr std::uint64_t highZ(int n) { return 0x0101010101010101u * ((0xffu << n) & 0xffu); }

// The middle leaf and a margin of `margin` voxels around it, as rows of bits along z: row (x, y), bit z + margin.
class Rows {
public:
    Rows(const Neighbourhood& around, int margin) : margin_(margin), edge_(8 + 2 * margin) {
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) {
                    const LeafMask* source = around[neighbourIndex(dx, dy, dz)];
                    if (source == nullptr) continue;
                    for (int x = std::max(0, -margin - 8 * dx); x < std::min(8, 8 + margin - 8 * dx); ++x) {
                        const std::uint64_t word = source->word[static_cast<std::size_t>(x)];
                        if (word == 0) continue;
                        for (int y = std::max(0, -margin - 8 * dy); y < std::min(8, 8 + margin - 8 * dy); ++y) {
                            const auto bits = static_cast<std::uint32_t>(word >> (8 * y)) & 0xffu;
                            const int shift = 8 * dz + margin;
                            at(x + 8 * dx, y + 8 * dy) |= (shift >= 0 ? bits << shift : bits >> -shift) & mask();
                        }
                    }
                }
    }

    /// -margin <= x, y < 8 + margin
    std::uint32_t& at(int x, int y) { return row_[index(x, y)]; }
    std::uint32_t at(int x, int y) const { return row_[index(x, y)]; }
    std::uint32_t mask() const { return (1u << edge_) - 1; }
    int margin() const { return margin_; }
    int edge() const { return edge_; }
    std::uint32_t* data() { return row_.data(); }
    const std::uint32_t* data() const { return row_.data(); }
    static constexpr std::size_t kStride = 8 + 2 * kFarthestReach;

    LeafMask middle() const {
        LeafMask out;
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                out.word[static_cast<std::size_t>(x)] |= std::uint64_t{(at(x, y) >> margin_) & 0xffu} << (8 * y);
        return out;
    }

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(x + margin_) * kStride + static_cast<std::size_t>(y + margin_);
    }
    int margin_, edge_;
    std::array<std::uint32_t, kStride * kStride> row_{};
};

}  // namespace

LeafMask withinReach(const Neighbourhood& around, double reach) {
    const int r = static_cast<int>(reach);
    // Rows already widened along z, by how far.
    std::array<Rows, kFarthestReach + 1> wide{Rows({}, r), Rows({}, r), Rows({}, r), Rows({}, r), Rows({}, r),
                                              Rows({}, r), Rows({}, r), Rows({}, r), Rows({}, r)};
    wide[0] = Rows(around, r);
    for (int n = 1; n <= r; ++n) {
        const std::uint32_t* from = wide[static_cast<std::size_t>(n - 1)].data();
        std::uint32_t* to = wide[static_cast<std::size_t>(n)].data();
        for (std::size_t row = 0; row < Rows::kStride * Rows::kStride; ++row)
            to[row] = from[row] | from[row] << 1 | from[row] >> 1;
    }
    Rows out({}, r);
    for (int dx = -r; dx <= r; ++dx)
        for (int dy = -r; dy <= r; ++dy) {
            const double rest = reach * reach - dx * dx - dy * dy;
            if (rest < 0) continue;
            const Rows& source = wide[static_cast<std::size_t>(std::sqrt(rest))];
            for (int x = 0; x < 8; ++x)
                for (int y = 0; y < 8; ++y) out.at(x, y) |= source.at(x + dx, y + dy);
        }
    return out.middle();
}

LeafMask spreadThrough(const Neighbourhood& open, const Neighbourhood& seeds, int steps) {
    const Rows through(open, steps);
    Rows reached(seeds, steps);
    Rows wide({}, steps);
    const int edge = reached.edge();
    for (int step = 0; step < steps; ++step) {
        for (int x = 0; x < edge; ++x) {
            const std::uint32_t* row = reached.data() + static_cast<std::size_t>(x) * Rows::kStride;
            std::uint32_t* to = wide.data() + static_cast<std::size_t>(x) * Rows::kStride;
            for (int y = 0; y < edge; ++y) {
                const std::uint32_t near = row[y] | (y > 0 ? row[y - 1] : 0) | (y + 1 < edge ? row[y + 1] : 0);
                to[y] = near | near << 1 | near >> 1;
            }
        }
        for (int x = 0; x < edge; ++x) {
            const std::size_t row = static_cast<std::size_t>(x) * Rows::kStride;
            for (std::size_t y = 0; y < static_cast<std::size_t>(edge); ++y) {
                std::uint32_t near = wide.data()[row + y];
                if (x > 0) near |= wide.data()[row - Rows::kStride + y];
                if (x + 1 < edge) near |= wide.data()[row + Rows::kStride + y];
                reached.data()[row + y] |= near & through.data()[row + y];
            }
        }
    }
    return reached.middle();
}

LeafMask besides(const Neighbourhood& around) {
    const auto at = [&](int dx, int dy, int dz, std::size_t x) {
        const LeafMask* mask = around[neighbourIndex(dx, dy, dz)];
        return mask == nullptr ? std::uint64_t{0} : mask->word[x];
    };
    LeafMask out;
    for (std::size_t x = 0; x < 8; ++x) {
        const std::uint64_t own = at(0, 0, 0, x);
        out.word[x] = own | (x > 0 ? at(0, 0, 0, x - 1) : at(-1, 0, 0, 7)) | (x < 7 ? at(0, 0, 0, x + 1) : at(1, 0, 0, 0)) |
                      (own << 8) | (own >> 8) | (at(0, -1, 0, x) >> 56) | (at(0, 1, 0, x) << 56) |
                      ((own & lowZ(1)) << 1) | ((own & highZ(1)) >> 1) | ((at(0, 0, -1, x) & highZ(7)) >> 7) |
                      ((at(0, 0, 1, x) & lowZ(7)) << 7);
    }
    return out;
}

LeafMask floodWithin(const LeafMask& open, const LeafMask& seeds) {
    LeafMask reached;
    for (std::size_t x = 0; x < 8; ++x) reached.word[x] = seeds.word[x] & open.word[x];
    while (true) {
        LeafMask grown;
        for (std::size_t x = 0; x < 8; ++x) {
            const std::uint64_t own = reached.word[x];
            std::uint64_t w = own | (own << 8) | (own >> 8) | ((own & lowZ(1)) << 1) | ((own & highZ(1)) >> 1);
            if (x > 0) w |= reached.word[x - 1];
            if (x < 7) w |= reached.word[x + 1];
            grown.word[x] = w & open.word[x];
        }
        if (grown == reached) return reached;
        reached = grown;
    }
}

}  // namespace stratum::voxelize
