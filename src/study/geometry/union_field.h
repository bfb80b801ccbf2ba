// The exact union of a print's beads: how far a point is from it, and points on its surface.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "study/geometry/exact_solid.h"
#include "voxelize/beads/bead_field.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::study {

/// Outside, the distance is exact; inside it is negative but only a bound (the deepest bead's). Flats that touch within
/// voxelize::kWeldGap are welded, as the voxelizer does it: the plane between them is inside, not surface.
class UnionField : public ExactSolid {
public:
    /// `reach`: how far from a bead distances are told. Beads are listed in cells of 1 mm, as far as they reach.
    UnionField(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double reach);

    /// Signed distance, or `reach` if no bead is that near.
    double distance(const glm::dvec3& p) const override;

    /// On the level beads' union.
    std::vector<SurfacePoint> samplePoints(std::size_t count, std::uint32_t seed = 1) const override;

    const voxelize::Bounds& bounds() const override { return bounds_; }

private:
    struct Solid {
        voxelize::BeadField field;
        voxelize::Section section;
        glm::dvec3 start{0}, end{0};  // of the centre line
        glm::dvec3 arc_center{0};
        double arc_radius = 0, arc_from = 0, arc_sweep = 0;
        double length = 0;
        double height = 0;  // of its layer
    };
    template <typename Random>
    bool tryPoint(Random& random, SurfacePoint& point) const;
    bool onOthersFlat(std::size_t own, const glm::dvec3& p, bool top) const;
    std::span<const std::uint32_t> near(const glm::dvec3& p) const;
    glm::ivec3 cellOf(const glm::dvec3& p) const;
    std::size_t indexOf(const glm::ivec3& cell) const;
    void listBeads();

    double reach_;
    std::vector<Solid> solids_;
    voxelize::Bounds bounds_;
    glm::ivec3 cells_{0};
    std::vector<std::uint32_t> first_;  // by cell, into listed_
    std::vector<std::uint32_t> listed_;
    std::vector<double> area_;  // running sums by solid, mm^2; sloped beads have none
};

}  // namespace stratum::study
