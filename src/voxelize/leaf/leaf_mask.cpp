#include "voxelize/leaf/leaf_mask.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

// Bits whose z is one of 0..7-n or n..7: those that a shift by n along z keeps in the leaf.
constexpr std::uint64_t lowZ(int n) { return 0x0101010101010101u * (0xffu >> n); }
constexpr std::uint64_t highZ(int n) { return 0x0101010101010101u * ((0xffu << n) & 0xffu); }

// The middle leaf and a margin around it, as rows of bits along z: row (x + margin, y + margin), bit z + margin. Only
// the edge x edge rows in use are ever written or read.
constexpr std::size_t kRowStride = 8 + 2 * kFarthestReach;
using Rows = std::uint32_t[kRowStride * kRowStride];

void fillRows(const Neighbourhood& around, int margin, Rows& rows) {
    static constexpr LeafMask kNone{};
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy) {
            const LeafMask* along_z[3];
            for (int dz = -1; dz <= 1; ++dz) {
                const LeafMask* source = around[neighbourIndex(dx, dy, dz)];
                along_z[dz + 1] = source != nullptr ? source : &kNone;
            }
            const int shift = 8 * dy + margin;
            const int y0 = std::max(0, -margin - 8 * dy);
            const int y1 = std::min(8, 8 + margin - 8 * dy);
            for (int x = std::max(0, -margin - 8 * dx); x < std::min(8, 8 + margin - 8 * dx); ++x) {
                const std::uint64_t below = along_z[0]->word[static_cast<std::size_t>(x)];
                const std::uint64_t here = along_z[1]->word[static_cast<std::size_t>(x)];
                const std::uint64_t above = along_z[2]->word[static_cast<std::size_t>(x)];
                std::uint32_t* row = rows + static_cast<std::size_t>(x + 8 * dx + margin) * kRowStride;
                const auto byte = [](std::uint64_t word, int y) {
                    return static_cast<std::uint32_t>(word >> (8 * y)) & 0xffU;
                };
                const std::uint32_t top = (1U << margin) - 1;
                for (int y = y0; y < y1; ++y)
                    row[y + shift] = byte(below, y) >> (8 - margin) | byte(here, y) << margin |
                                     (byte(above, y) & top) << (8 + margin);
            }
        }
}

LeafMask middleOf(const Rows& rows, int margin) {
    LeafMask out;
    for (std::size_t x = 0; x < 8; ++x)
        for (std::size_t y = 0; y < 8; ++y) {
            const std::size_t m = static_cast<std::size_t>(margin);
            out.word[x] |= std::uint64_t{(rows[(x + m) * kRowStride + y + m] >> margin) & 0xffu} << (8 * y);
        }
    return out;
}

}  // namespace

bool anyWithin(const Neighbourhood& around, int reach) {
    // Bytes (y) and bits (z) of a word that lie that near, for a neighbour on the low side, here, and on the high side.
    const int far = 8 - reach;
    const std::uint64_t along_y[3] = {~std::uint64_t{0} << 8 * far % 64, ~std::uint64_t{0},
                                      reach == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * reach) - 1};
    const std::uint64_t along_z[3] = {highZ(far), ~std::uint64_t{0}, lowZ(far)};
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz) {
                const LeafMask* source = around[neighbourIndex(dx, dy, dz)];
                if (source == nullptr) continue;
                std::uint64_t any = 0;
                for (int x = dx < 0 ? far : 0; x < (dx > 0 ? reach : 8); ++x)
                    any |= source->word[static_cast<std::size_t>(x)];
                if ((any & along_y[dy + 1] & along_z[dz + 1]) != 0) return true;
            }
    return false;
}

LeafMask dilateBall(const Neighbourhood& around, double reach) {
    const int r = static_cast<int>(reach);
    const int edge = 8 + 2 * r;
    // Rows dilated along z, by radius. Not initialized, because few are used.
    Rows wide[kFarthestReach + 1];
    fillRows(around, r, wide[0]);
    for (int n = 1; n <= r; ++n)
        for (int x = 0; x < edge; ++x) {
            const std::size_t row = static_cast<std::size_t>(x) * kRowStride;
            for (std::size_t y = row; y < row + static_cast<std::size_t>(edge); ++y)
                wide[n][y] = wide[n - 1][y] | wide[n - 1][y] << 1 | wide[n - 1][y] >> 1;
        }
    std::uint32_t near[8][8] = {};
    for (int dx = -r; dx <= r; ++dx)
        for (int dy = -r; dy <= r; ++dy) {
            const double rest = reach * reach - dx * dx - dy * dy;
            if (rest < 0) continue;
            const std::uint32_t* source = wide[static_cast<int>(std::sqrt(rest))];
            for (int x = 0; x < 8; ++x)
                for (int y = 0; y < 8; ++y)
                    near[x][y] |= source[static_cast<std::size_t>(x + dx + r) * kRowStride +
                                         static_cast<std::size_t>(y + dy + r)];
        }
    LeafMask out;
    for (std::size_t x = 0; x < 8; ++x)
        for (std::size_t y = 0; y < 8; ++y) out.word[x] |= std::uint64_t{(near[x][y] >> r) & 0xffu} << (8 * y);
    return out;
}

LeafMask spreadThrough(const Neighbourhood& open, const Neighbourhood& seeds, int steps) {
    Rows through;
    Rows reached;
    Rows wide;
    fillRows(open, steps, through);
    fillRows(seeds, steps, reached);
    const int edge = 8 + 2 * steps;
    for (int step = 1; step <= steps; ++step) {
        // Rows that the remaining steps can't bring into the middle leaf are skipped.
        const int first = step - 1;
        const int last = edge - step;
        for (int x = first; x <= last; ++x) {
            const std::uint32_t* row = reached + static_cast<std::size_t>(x) * kRowStride;
            std::uint32_t* to = wide + static_cast<std::size_t>(x) * kRowStride;
            for (int y = first + 1; y < last; ++y) {
                const std::uint32_t near = row[y - 1] | row[y] | row[y + 1];
                to[y] = near | near << 1 | near >> 1;
            }
        }
        for (int x = first + 1; x < last; ++x) {
            const std::size_t row = static_cast<std::size_t>(x) * kRowStride;
            for (int y = first + 1; y < last; ++y) {
                const std::size_t at = row + static_cast<std::size_t>(y);
                reached[at] |= (wide[at - kRowStride] | wide[at] | wide[at + kRowStride]) & through[at];
            }
        }
    }
    return middleOf(reached, steps);
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
