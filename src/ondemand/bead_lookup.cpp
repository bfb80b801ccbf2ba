#include "ondemand/bead_lookup.h"

#include <limits>

namespace stratum::ondemand {
namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

}  // namespace

BeadLookup::BeadLookup(const PrintField& field) : field_(field), map_(field.transform().baseMap()) {}

std::optional<std::uint32_t> BeadLookup::at(const glm::dvec3& position) {
    const openvdb::Vec3d p = map_->applyInverseMap(openvdb::Vec3d(position.x, position.y, position.z));
    const openvdb::Coord cell = openvdb::Coord::floor(p);
    double nearest = 4.0;  // more than any corner's
    std::uint32_t bead = kNobody;
    for (int c = 0; c < 8; ++c) {
        const openvdb::Coord voxel = cell.offsetBy(c >> 2, c >> 1 & 1, c & 1);
        const double square = (p - voxel.asVec3d()).lengthSqr();
        if (square >= nearest) continue;
        const auto here = ownerOf(voxel);
        if (!here) continue;
        nearest = square;
        bead = *here;
    }
    if (bead == kNobody) return std::nullopt;
    return bead;
}

// The bead whose surface is nearest to a voxel that is active or inside; nothing for others.
std::optional<std::uint32_t> BeadLookup::ownerOf(const openvdb::Coord& voxel) {
    const openvdb::Coord origin = voxel & ~(voxelize::kLeafDim - 1);
    const auto bit = [&origin](int axis) { return static_cast<unsigned>(origin[axis]) >> 3; };
    constexpr unsigned kLast = kSide - 1;
    const std::size_t place = (bit(0) & kLast) * kSide * kSide + (bit(1) & kLast) * kSide + (bit(2) & kLast);
    if (origins_[place] != origin) fill(place, origin);
    const Owned& leaf = cache_[place];
    const openvdb::Index n = voxelize::Leaf::coordToOffset(voxel);
    if ((leaf.outside[n >> 6] >> (n & 63) & 1) != 0 || leaf.rank[n] == kNobody) return std::nullopt;
    return field_.layout().stack.beads[leaf.rank[n]];
}

void BeadLookup::fill(std::size_t place, const openvdb::Coord& origin) {
    Owned& leaf = cache_[place];
    origins_[place] = openvdb::Coord::max();  // invalid if evaluation throws
    leaf.outside.fill(~std::uint64_t{0});
    LeafMaker& maker = field_.maker();
    const voxelize::LeafContent content = maker.make(origin, field_.printed());
    if (content != voxelize::LeafContent::outside) {
        std::array<float, voxelize::Leaf::SIZE> values;
        voxelize::storeLeaf(maker.column().planes(), values.data());
        voxelize::maskFrom(values.data(), field_.background(), leaf.outside.data());
        maker.owners(leaf.rank);
    }
    origins_[place] = origin;
}

}  // namespace stratum::ondemand
