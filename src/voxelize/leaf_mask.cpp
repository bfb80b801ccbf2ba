#include "voxelize/leaf_mask.h"

#include <algorithm>

namespace stratum::voxelize {
namespace {

// Bits whose z is one of 0..7-n or n..7: what a shift by n along z may keep.
constexpr std::uint64_t lowZ(int n) { return 0x0101010101010101u * (0xffu >> n); }
constexpr std::uint64_t highZ(int n) { return 0x0101010101010101u * ((0xffu << n) & 0xffu); }

// A row of 24 bytes along y, or of 24 bits along z: what of the middle 8 lies within `reach` of a set one.
std::uint64_t dilateY(std::uint64_t before, std::uint64_t middle, std::uint64_t after, int reach) {
    std::uint64_t out = middle;
    for (int n = 1; n <= reach; ++n) {
        // A shift by 64 is undefined in C++; the neighbours' part then is the whole word.
        if (n < 8) out |= (middle << (8 * n)) | (middle >> (8 * n));
        const int rest = 8 * (8 - n);
        out |= n == 8 ? before | after : (before >> rest) | (after << rest);
    }
    return out;
}

std::uint64_t dilateZ(std::uint64_t before, std::uint64_t middle, std::uint64_t after, int reach) {
    std::uint64_t out = middle;
    for (int n = 1; n <= reach; ++n) {
        if (n < 8) out |= ((middle & lowZ(n)) << n) | ((middle & highZ(n)) >> n);
        const int rest = 8 - n;
        out |= n == 8 ? before | after : ((before & highZ(rest)) >> rest) | ((after & lowZ(rest)) << rest);
    }
    return out;
}

}  // namespace

LeafMask dilate(const Neighbourhood& around, int reach) {
    // Axis by axis: x first, for each of the nine columns of leaves along x; then y; then z.
    LeafMask along_x[3][3];
    bool any[3][3] = {};
    for (int dy = 0; dy < 3; ++dy)
        for (int dz = 0; dz < 3; ++dz)
            for (int dx = -1; dx <= 1; ++dx) {
                const LeafMask* source = around[neighbourIndex(dx, dy - 1, dz - 1)];
                if (source == nullptr) continue;
                any[dy][dz] = true;
                LeafMask& out = along_x[dy][dz];
                // Source word s lies at s + 8 dx.
                for (int s = 0; s < 8; ++s) {
                    const std::uint64_t w = source->word[static_cast<std::size_t>(s)];
                    if (w == 0) continue;
                    const int at = s + 8 * dx;
                    for (int x = std::max(0, at - reach); x <= std::min(7, at + reach); ++x)
                        out.word[static_cast<std::size_t>(x)] |= w;
                }
            }
    LeafMask along_y[3];
    for (int dz = 0; dz < 3; ++dz)
        if (any[0][dz] || any[1][dz] || any[2][dz])
            for (std::size_t x = 0; x < 8; ++x)
                along_y[dz].word[x] =
                    dilateY(along_x[0][dz].word[x], along_x[1][dz].word[x], along_x[2][dz].word[x], reach);
    LeafMask out;
    for (std::size_t x = 0; x < 8; ++x)
        out.word[x] = dilateZ(along_y[0].word[x], along_y[1].word[x], along_y[2].word[x], reach);
    return out;
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
                      dilateY(at(0, -1, 0, x), own, at(0, 1, 0, x), 1) | dilateZ(at(0, 0, -1, x), own, at(0, 0, 1, x), 1);
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
