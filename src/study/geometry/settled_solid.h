// The exact solid of settled beads: what docs/deposit.md defines, bead by bead in double.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "study/geometry/exact_solid.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/layer_stack.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace stratum::study {

/// Of level beads whose toolpath settles (gcode::DepositModel); a union without that. Its values are those that the
/// voxelizer's float kernels approximate: distances between parallel beads, steeper than that by up to slope() where
/// beads turn.
class SettledSolid : public ExactSolid {
public:
    /// `reach`: how far from a bead distances are told, mm.
    SettledSolid(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double reach);

    double distance(const glm::dvec3& p) const override;
    double slope() const override;
    const voxelize::Bounds& bounds() const override { return bounds_; }
    /// Where lines that are spread evenly cross the surface: as many by area everywhere. Gaps narrower than kLineStep
    /// are passed over.
    std::vector<SurfacePoint> samplePoints(std::size_t count, std::uint32_t seed = 1) const override;

    static constexpr double kLineStep = 0.002;  ///< mm

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
