// A bead's path in the plan (xy), measured in mm from its start, and which parts of it are near another path.
#pragma once

#include "gcode/toolpath/arc.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <vector>

namespace stratum::deposit {

/// A part of a path, mm from its start.
struct PathPart {
    double from = 0;
    double to = 0;
};

/// A segment or a circular arc. Arcs have the mean of both ends' radii, as gcode::Arc says.
class BeadPath {
public:
    BeadPath(const gcode::Toolpath& toolpath, const gcode::Bead& bead);

    /// In the plan, mm.
    double length() const { return length_; }
    bool straight() const { return radius_ == 0; }
    double radius() const { return radius_; }  ///< mm; 0 if straight
    double turn() const { return sweep_; }     ///< radians, counter-clockwise positive; 0 if straight

    gcode::PlanPoint at(double mm) const;
    /// From (x, y) to the path, mm.
    double distance(double x, double y) const;

    /// mm along the path to its place nearest to (x, y).
    double nearest(double x, double y) const;

    /// Appends the parts of this path that are within `reach` (mm) of `other`. Two segments: one part at most, in
    /// closed form. With an arc: the ends are bisected to a micrometre, and parts shorter than kFineStep may be missed.
    /// Returns how many distances that took; closed forms count as one.
    std::size_t partsNear(const BeadPath& other, double reach, std::vector<PathPart>& parts) const;

    /// The same for the places that are beside `other`: within `reach` of their nearest place on it, which is in its
    /// part `held`, and seen from which they lie more across this path than along it (so not ahead of an end, nor where
    /// the two cross steeply). Parts may overlap. A path of no length has no direction: for it, reach and part decide.
    std::size_t partsBeside(const BeadPath& other, PathPart held, double reach, std::vector<PathPart>& parts) const;

    static constexpr double kFineStep = 0.05;  ///< mm

private:
    void segmentNearSegment(const BeadPath& other, double reach, std::vector<PathPart>& parts) const;
    void segmentBesideSegment(const BeadPath& other, PathPart held, double reach, std::vector<PathPart>& parts) const;
    bool beside(double mm, const BeadPath& other, PathPart held) const;
    template <typename Beyond>
    std::size_t walk(const Beyond& beyond, std::vector<PathPart>& parts) const;

    double x0_, y0_, x1_, y1_;  // mm
    double ux_ = 0, uy_ = 0;    // unit direction of a segment; 0 for a point
    double length_ = 0;         // mm
    double center_x_ = 0, center_y_ = 0, radius_ = 0, sweep_ = 0, angle_ = 0;
};

}  // namespace stratum::deposit
