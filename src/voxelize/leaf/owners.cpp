// LeafColumn::owners: the bead whose surface is nearest to each voxel.
#include "voxelize/beads/bead_field.h"
#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {

void LeafColumn::owners(std::span<std::uint32_t, Leaf::SIZE> ranks) const {
    constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
    // Plane by plane, as plan fields are.
    PlanField nearest[kLeafPlanes];
    PlanOwners owners[kLeafPlanes];
    for (PlanField& plane : nearest) std::fill(std::begin(plane.v), std::end(plane.v), 1e38F);
    for (PlanOwners& plane : owners) std::fill(std::begin(plane.v), std::end(plane.v), kNobody);
    const int k0 = leaf_k_ * kLeafDim;
    for (const std::uint32_t slot : window_) {
        const PlanLayer& plan = slots_[slot];
        const auto radius = static_cast<float>(plan.radius * scale_);
        const auto half_side = static_cast<float>(plan.half_side * scale_);
        for (int z = 0; z < kLeafDim; ++z) {
            const double dz = sampleZ(k0 + z) - plan.center_z;
            const double reach = plan.half_height + band_;
            if (dz <= -reach || dz >= reach + plan.most_rise) continue;
            PlanField over;
            if (plan.rises && dz > 0) {
                // As PlaneTerm::rise has it.
                const auto height = static_cast<float>(dz * scale_);
                for (std::size_t c = 0; c < kColumnSamples; ++c)
                    over.v[c] = std::max(std::min(height - plan.rise.v[c], 2 * height), 0.0F) - half_side;
            } else {
                const auto level = static_cast<float>((std::abs(dz) - plan.half_side) * scale_);
                std::fill(std::begin(over.v), std::end(over.v), level);
            }
            PlanField distance;
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                const float above = std::max(over.v[c], 0.0F);
                distance.v[c] = std::sqrt(plan.sides2.v[c] + above * above) - radius;
            }
            if (plan.half_side > 0)
                for (std::size_t c = 0; c < kColumnSamples; ++c)
                    distance.v[c] += std::min(std::max(plan.d.v[c], over.v[c]), 0.0F);
            float* const least = nearest[static_cast<std::size_t>(z)].v;
            std::uint32_t* const owner = owners[static_cast<std::size_t>(z)].v;
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                const std::uint32_t rank = plan.owners.v[c];
                const bool nearer = (distance.v[c] < least[c]) | ((distance.v[c] == least[c]) & (rank < owner[c]));
                least[c] = nearer ? distance.v[c] : least[c];
                owner[c] = nearer ? rank : owner[c];
            }
        }
    }
    for (std::size_t n = 0; n < Leaf::SIZE; ++n) ranks[n] = owners[n % kLeafPlanes].v[n / kLeafPlanes];
    const double z_min = sampleZ(k0);
    const double z_max = sampleZ(k0 + kLeafDim - 1);
    for (const DirectBead& direct : direct_) {
        if (direct.z_max < z_min || direct.z_min > z_max) continue;
        const BeadField field(toolpath_, toolpath_.beads[stack_.beads[direct.rank]]);
        for (std::size_t n = 0; n < Leaf::SIZE; ++n) {
            const double x = (i_ + static_cast<int>(n / 64)) * lattice_.voxel_size;
            const double y = (j_ + static_cast<int>(n / 8 % 8)) * lattice_.voxel_size;
            const double z = sampleZ(k0 + static_cast<int>(n % 8));
            const auto distance = static_cast<float>(field.distance(x, y, z) * scale_);
            float& least = nearest[n % kLeafPlanes].v[n / kLeafPlanes];
            if (distance > least || (distance == least && direct.rank > ranks[n])) continue;
            least = distance;
            ranks[n] = direct.rank;
        }
    }
}

}  // namespace stratum::voxelize
