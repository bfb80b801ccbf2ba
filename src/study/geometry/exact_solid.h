// The exact solid of a print's beads: what docs/deposit.md defines, bead by bead in double.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/layer_stack.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace stratum::study {

/// Of beads whose toolpath settles (gcode::DepositModel), else their union. Its values are those that the voxelizer's
/// float kernels approximate. Outside, distances are exact where nothing settles; inside they are negative and a bound.
/// Settled: exact between parallel beads, steeper than that by up to slope() where beads turn. Everything in mm and
/// print space. Immutable; safe to ask from all threads.
class ExactSolid {
public:
    /// `reach`: how far from a bead distances are told. Throws UsageError if there is no bead, or the box is too large.
    ExactSolid(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double reach);
    ExactSolid(const ExactSolid&) = delete;
    ExactSolid& operator=(const ExactSolid&) = delete;

    double distance(const glm::dvec3& p) const;
    /// How fast distance() may change at most.
    double slope() const;
    /// Of all that distance() tells.
    const voxelize::Bounds& bounds() const { return bounds_; }

    struct SurfacePoint {
        glm::dvec3 position{0};
        glm::dvec3 normal{0};  ///< unit, outwards
    };
    /// Where lines that are spread evenly cross the surface, inner surfaces included: as many by area everywhere. Gaps
    /// narrower than kLineStep are passed over. Depends on `seed` and the number alone. Parallel.
    std::vector<SurfacePoint> samplePoints(std::size_t count, std::uint32_t seed = 1) const;
    static constexpr double kLineStep = 0.002;  ///< mm

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

private:
    // Levels of a groove over half its gap, in corner radii, dense where they change fast.
    struct Levels {
        double closing = 0;
        std::vector<double> values;
        double at(double m) const;
    };
    struct Plan {
        double settled, closed;
        double rise;  // mm, of the top
    };
    struct Near {
        double d, nx, ny;
    };

    Plan filled(std::size_t layer, double x, double y) const;
    Plan plan(std::size_t layer, double x, double y) const;
    Near nearTo(std::uint32_t rank, double x, double y) const;
    double welded(const glm::dvec3& p, std::span<const std::pair<std::uint32_t, double>> closed) const;
    std::size_t cellOf(double x, double y) const;
    void listBeads();
    void crossings(std::uint64_t seed, std::vector<SurfacePoint>& found) const;
    SurfacePoint pointBetween(const glm::dvec3& a, const glm::dvec3& b, bool a_inside) const;

    const gcode::Toolpath& toolpath_;
    const voxelize::LayerStack stack_;
    double reach_;
    std::vector<voxelize::BeadField> fields_;  // by rank
    std::vector<Levels> levels_;               // by layer
    voxelize::Bounds bounds_;
    std::size_t cells_x_ = 0, cells_y_ = 0;
    std::vector<std::vector<std::vector<std::uint32_t>>> cells_;  // ranks by layer (the last: single beads) and cell
};

}  // namespace stratum::study
