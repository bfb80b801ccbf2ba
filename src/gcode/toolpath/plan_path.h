// A bead's path in the plan (xy): a line segment or a circular arc. All is closed form; arcs are not tessellated.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <algorithm>
#include <cmath>

namespace stratum::gcode {

struct PlanPoint {
    double x = 0;  ///< mm
    double y = 0;  ///< mm
};

/// Places on the path are named by their mm from its start. Arcs have the mean of both ends' radii, as Arc says; an arc
/// that starts or ends at its own center is its chord.
class PlanPath {
public:
    PlanPath(const Toolpath& toolpath, const Bead& bead);

    /// In the plan, mm.
    double length() const { return length_; }
    bool straight() const { return radius_ == 0; }
    double radius() const { return radius_; }  ///< mm; 0 if straight
    double turn() const { return sweep_; }     ///< radians, counter-clockwise positive; 0 if straight
    PlanPoint center() const { return center_; }
    /// Unit vectors from the center to the ends of an arc.
    PlanPoint startSide() const { return start_; }
    PlanPoint endSide() const { return end_; }

    PlanPoint at(double mm) const;
    /// Unit vector; (0, 0) of a path without length.
    PlanPoint direction(double mm) const;

    /// Distance in mm from (x, y) to the path.
    double distance(double x, double y) const {
        if (radius_ > 0) return arcDistance(x, y);
        const double px = x - x0_;
        const double py = y - y0_;
        const double t = std::clamp((px * dx_ + py * dy_) * inverse_length2_, 0.0, 1.0);
        const double qx = px - t * dx_;
        const double qy = py - t * dy_;
        return std::sqrt(qx * qx + qy * qy);
    }
    /// Fraction 0..1 along the path of the point nearest to (x, y); of an arc's ends the nearer one where neither side
    /// of it is.
    double parameter(double x, double y) const;
    /// The place of that point, mm.
    double nearest(double x, double y) const;

    /// Extent in x and y, mm.
    void bounds(double (&min)[2], double (&max)[2]) const;

private:
    bool withinSweep(double vx, double vy) const;
    double arcDistance(double x, double y) const;

    double x0_, y0_, x1_, y1_;
    double dx_, dy_;          // chord
    double inverse_length2_;  // 0 for a point: then every t is 0
    double length_;
    // Arc only; radius_ == 0 marks a straight path.
    double radius_ = 0, sweep_ = 0;
    PlanPoint center_, start_, end_;
};

}  // namespace stratum::gcode
