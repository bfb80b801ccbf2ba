// The exact field of a print at any point, without a lattice.
#pragma once

#include "ondemand/print_layout.h"

#include <glm/vec3.hpp>

namespace stratum::ondemand {

/// What voxelize() samples, between its samples: the distance to the union of the beads, welded. Immutable; shared by
/// all threads. Print space, mm, double.
class PointDistance {
public:
    /// `layout` must outlive it. Throws UsageError for beads that settle: how far a groove fills is known on a lattice
    /// only.
    explicit PointDistance(const PrintLayout& layout);

    /// Signed distance: exact outside, negative but a bound inside. Points farther away than reach() have reach().
    double at(const glm::dvec3& point) const;
    /// mm: the half-width less one voxel.
    double reach() const { return reach_; }

private:
    const PrintLayout& layout_;
    double reach_;
};

}  // namespace stratum::ondemand
