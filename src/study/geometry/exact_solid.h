// A solid that is known exactly: what level sets are held against.
#pragma once

#include "voxelize/beads/bead_field.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace stratum::study {

/// Everything in mm and print space, double. Immutable once made; safe to ask from all threads.
class ExactSolid {
public:
    ExactSolid() = default;
    ExactSolid(const ExactSolid&) = delete;
    ExactSolid& operator=(const ExactSolid&) = delete;
    virtual ~ExactSolid() = default;

    /// Signed distance, or a bound of it; as far as the solid's reach.
    virtual double distance(const glm::dvec3& p) const = 0;
    /// How fast distance() may change at most.
    virtual double slope() const { return 1; }
    /// Of all that distance() tells.
    virtual const voxelize::Bounds& bounds() const = 0;

    struct SurfacePoint {
        glm::dvec3 position{0};
        glm::dvec3 normal{0};  ///< unit, outwards
    };
    /// Points spread evenly by area over the surface, inner surfaces included. Depends on `seed` and the number alone.
    /// Parallel.
    virtual std::vector<SurfacePoint> samplePoints(std::size_t count, std::uint32_t seed = 1) const = 0;

    /// How far the empty space in front of a point of the surface goes, along its normal, mm; `limit` if farther. What
    /// is narrower than a few voxels can't be on a grid: gaps between beads side by side narrow down to nothing.
    double clearance(const SurfacePoint& point, double limit) const;

    /// mm^3, and their standard errors: of the solid, and by how much another one is larger, both counted at the same
    /// quasi-random points of the box, so that their difference is known better than either.
    struct Volume {
        double value = 0, error = 0;
        double excess = 0, excess_error = 0;
    };
    using Inside = std::function<bool(const glm::dvec3&)>;
    /// @param other  makes a function for one thread to ask whether a point is inside the other solid; may be empty
    Volume volume(std::size_t points_of_each, const std::function<Inside()>& other = {}, int shifts = 16) const;
};

}  // namespace stratum::study
