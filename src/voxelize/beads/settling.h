// Settling: the plastic that two neighbouring beads of a layer both claim fills the groove between them.
//
// Two parallel beads with corners of radius r, whose flats are a gap g = 2 m apart, m < r, claim the same area
// E = 2 int_m^r T and leave open C = 2 int_0^m V beneath and above, with T(d) the thickness of a bead at the distance d
// from its flat, and V = height - T the depth of the groove, both sides together:
//     T(d) = height - 2 r + 2 sqrt(r^2 - d^2),  V(d) = 2 r - 2 sqrt(r^2 - d^2)        0 < d < r
// As a viscous liquid would, the claimed area fills the groove from its bottom, in the middle, up to a level: where
// d > level, the thickness is T(level), with
//     2 int_level^m (V(d) - V(level)) dd = min(E, C).
// So the sum of both areas is kept, for every gap with E <= C, and at the spacing of the slicers, width - height
// (1 - pi / 4) for a stadium, the layer closes to a slab. Where more is claimed (E > C) there is no room for it.
//
// In the plan field a filled groove is min(d, level). The level is constant between parallel beads, so the slope stays
// 1 there; where the gap narrows, the depth of each face changes by about height / (2 m) times the change of m. See
// docs/deposit.md.
// Source of the section: Comminal et al. 2018, doi 10.1016/j.addma.2017.12.013.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <vector>

namespace stratum::voxelize {

/// The level of a groove for one shape of section, in units of the corner radius. Immutable.
class SettlingCurve {
public:
    /// Steps of table(): the error of interpolated volumes is below 1e-6 of a bead's.
    static constexpr int kSteps = 512;

    /// `ratio`: height over corner radius, at least 2. `weld_gap`: the part of the height that welds close.
    SettlingCurve(double ratio, double weld_gap);

    double ratio() const { return ratio_; }
    /// Half the gap, in radii, at which the groove is just filled.
    double closing() const { return closing_; }
    /// Of half a gap of `m` radii: 0 up to closing(), 1 from 1 on. Solves the equation; slow.
    double level(double m) const;
    /// Levels at equal steps of z = 1 - sqrt(1 - sqrt(q)), q = (m - closing) / (1 - closing): kSteps + 1 values. Both
    /// roots remove a vertical tangent, so that linear interpolation suffices.
    const std::vector<float>& table() const { return table_; }

    /// In radii: V(weldLevel()) is the gap that welds close. The faces of two such grooves, one over the other, are as
    /// near as two planes that count as touching.
    double weldLevel() const { return weld_level_; }

private:
    double ratio_, closing_, weld_level_;
    std::vector<float> table_;
};

/// Two beads fill their groove where the directions from their paths to a point are about opposite: where the cosine
/// between them is above kOpposite, the gap is counted larger by kTurnPenalty r ((cosine - kOpposite) / -kOpposite)^2.
/// Neighbours along one path lie in the same direction and don't fill each other.
constexpr double kOpposite = -0.9;
constexpr double kTurnPenalty = 2;

/// Lengths of settling and of its measurement grow with the beads, so that a print ten times as large settles alike: 1
/// for prints with layers of 0.4 mm and less, else the height of the lowest layer in units of that.
double settlingScale(const gcode::Toolpath& toolpath);

/// The most by which an outline moves out where plastic is left over, mm at a settlingScale() of 1: see swell_field.h.
constexpr double kMostSwell = 0.1;

/// The most by which the top of a layer is raised by what has no place in it, mm at a settlingScale() of 1; less in
/// layers lower than twice that.
constexpr double kMostRise = 0.1;

/// Outside the solid no slope of a settled field is larger: at most 2.82 as measured on real prints, in turns (above
/// 1.05 at about one point in 1000), and 0.53 of a swell. Sphere tracing must divide its steps by it. Between
/// parallel beads the slope is 1.
constexpr double kSettledSlope = 3.4;

}  // namespace stratum::voxelize
