#include "export/packed_masks.h"

#include "base/error.h"

#include <blosc.h>

namespace stratum::exporter {

// Walls repeat their masks from leaf to leaf: LZ4 finds that at its lowest level, and bytes stay in their order.
PackedMasks::PackedMasks(std::span<const LeafMask> masks) : count_(masks.size()) {
    constexpr int kLevel = 1;
    if (masks.empty()) return;
    std::vector<char> room(masks.size_bytes() + BLOSC_MAX_OVERHEAD);
    const int bytes = blosc_compress_ctx(kLevel, BLOSC_NOSHUFFLE, 1, masks.size_bytes(), masks.data(), room.data(),
                                         room.size(), BLOSC_LZ4_COMPNAME, 0, 1);
    if (bytes <= 0) throw OutputError("Blosc can't pack the masks of leaves");
    packed_.assign(room.begin(), room.begin() + bytes);
}

void PackedMasks::write(std::ostream& out) const {
    if (count_ == 0) return;
    std::vector<char> masks(count_ * sizeof(LeafMask));
    if (blosc_decompress_ctx(packed_.data(), masks.data(), masks.size(), 1) != static_cast<int>(masks.size()))
        throw OutputError("Blosc can't unpack the masks of leaves");
    out.write(masks.data(), static_cast<std::streamsize>(masks.size()));
}

}  // namespace stratum::exporter
