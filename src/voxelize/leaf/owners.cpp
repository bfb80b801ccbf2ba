// LeafColumn::owners: the bead whose surface is nearest to each voxel.
#include "voxelize/beads/bead_field.h"
#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {

void LeafColumn::owners(std::span<std::uint32_t, Leaf::SIZE> ranks) const {
    float nearest[Leaf::SIZE];
    std::fill(std::begin(nearest), std::end(nearest), std::numeric_limits<float>::max());
    std::fill(ranks.begin(), ranks.end(), std::numeric_limits<std::uint32_t>::max());
    const int k0 = leaf_k_ * kLeafDim;
    const auto claim = [&](std::size_t n, float distance, std::uint32_t rank) {
        if (distance < nearest[n] || (distance == nearest[n] && rank < ranks[n])) {
            nearest[n] = distance;
            ranks[n] = rank;
        }
    };
    for (const std::uint32_t slot : window_) {
        const PlanLayer& plan = slots_[slot];
        const auto radius = static_cast<float>(plan.radius * scale_);
        const bool straight_sides = plan.half_side > 0;
        for (int z = 0; z < kLeafDim; ++z) {
            const double dz = sampleZ(k0 + z) - plan.center_z;
            const double reach = plan.half_height + band_;
            if (dz <= -reach || dz >= reach + plan.most_rise) continue;
            const auto height = static_cast<float>(dz * scale_);
            const auto half_side = static_cast<float>(plan.half_side * scale_);
            const auto level = static_cast<float>((std::abs(dz) - plan.half_side) * scale_);
            for (std::size_t c = 0; c < kColumnSamples; ++c) {
                // Where the top is raised, as PlaneTerm::rise has it.
                float over = level;
                if (plan.most_rise > 0)
                    over = std::abs(std::max(std::min(height - plan.rise.v[c], 2 * height), std::min(height, 0.0F))) -
                           half_side;
                const float above = std::max(over, 0.0F);
                float distance = std::sqrt(plan.sides2.v[c] + above * above) - radius;
                if (straight_sides) distance += std::min(std::max(plan.d.v[c], over), 0.0F);
                claim(c * kLeafPlanes + static_cast<std::size_t>(z), distance, plan.owners.v[c]);
            }
        }
    }
    const double z_min = sampleZ(k0);
    const double z_max = sampleZ(k0 + kLeafDim - 1);
    for (const DirectBead& direct : direct_) {
        if (direct.z_max < z_min || direct.z_min > z_max) continue;
        const BeadField field(toolpath_, toolpath_.beads[stack_.beads[direct.rank]]);
        for (std::size_t n = 0; n < Leaf::SIZE; ++n) {
            const double x = (i_ + static_cast<int>(n / 64)) * lattice_.voxel_size;
            const double y = (j_ + static_cast<int>(n / 8 % 8)) * lattice_.voxel_size;
            const double z = sampleZ(k0 + static_cast<int>(n % 8));
            claim(n, static_cast<float>(field.distance(x, y, z) * scale_), direct.rank);
        }
    }
}

}  // namespace stratum::voxelize
