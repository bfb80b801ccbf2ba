// The nearest bead of each sample of a leaf, in SIMD; see leaf_kernels.h.
#pragma once

#include "voxelize/leaf/leaf_kernels.h"

namespace stratum::voxelize {

/// One layer in one plane of a leaf, world units. `sides2`, `d` and `rise` as of PlaneTerm.
struct OwnedLayer {
    const PlanField* sides2 = nullptr;
    const PlanField* d = nullptr;     ///< only with straight sides
    const PlanField* rise = nullptr;  ///< null where the plane is not moved
    const PlanOwners* owners = nullptr;
    float radius = 0, half_side = 0;
    float dz = 0;    ///< height over the center plane; only with `rise`
    float over = 0;  ///< height over the straight sides; only without
};

/// The least distance so far, and whose it is: takes the layer's owners where it is nearer, or as near and they are
/// lower.
void takeNearer(const OwnedLayer& layer, PlanField& least, PlanOwners& owners);

}  // namespace stratum::voxelize
