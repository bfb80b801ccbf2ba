// LeafColumn::owners: the bead whose surface is nearest to each voxel.
#include "voxelize/beads/bead_field.h"
#include "voxelize/leaf/leaf_column.h"
#include "voxelize/leaf/owner_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {

void LeafColumn::findOwners(PlanLayer& plan) {
    const auto source = std::lower_bound(
        column_layers_.begin(), column_layers_.end(), plan.layer,
        [](const ColumnLayer& column_layer, std::uint32_t layer) { return column_layer.layer < layer; });
    gatherPaths(*source, true);
    minimumOfPaths(between_, &plan.owners);
    plan.owned = true;
}

void LeafColumn::owners(std::span<std::uint32_t, Leaf::SIZE> ranks) {
    constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
    // Plane by plane, as plan fields are.
    PlanField nearest[kLeafPlanes];
    PlanOwners owners[kLeafPlanes];
    for (PlanField& plane : nearest) std::fill(std::begin(plane.v), std::end(plane.v), 1e38F);
    for (PlanOwners& plane : owners) std::fill(std::begin(plane.v), std::end(plane.v), kNobody);
    const int k0 = leaf_k_ * kLeafDim;
    for (const std::uint32_t slot : window_) {
        PlanLayer& plan = slots_[slot];
        if (!plan.owned) findOwners(plan);
        OwnedLayer layer{.sides2 = &plan.sides2,
                         .d = plan.half_side > 0 ? &plan.d : nullptr,
                         .owners = &plan.owners,
                         .radius = static_cast<float>(plan.radius * scale_),
                         .half_side = static_cast<float>(plan.half_side * scale_)};
        for (int z = 0; z < kLeafDim; ++z) {
            const double dz = sampleZ(k0 + z) - plan.center_z;
            const double reach = plan.half_height + band_;
            if (dz <= -reach || dz >= reach + plan.most_rise) continue;
            // As PlaneTerm::rise has it.
            layer.rise = plan.rises && dz > 0 ? &plan.rise : nullptr;
            layer.dz = static_cast<float>(dz * scale_);
            layer.over = static_cast<float>((std::abs(dz) - plan.half_side) * scale_);
            takeNearer(layer, nearest[z], owners[z]);
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
