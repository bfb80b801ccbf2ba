#include "mechanics/bead_direction.h"

#include <cmath>
#include <numbers>

namespace stratum::mechanics {

BeadDirection directionAt(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    double dx = bead.x1 - bead.x0;
    double dy = bead.y1 - bead.y0;
    double climb = bead.z1 - bead.z0;
    double plan = std::hypot(dx, dy);
    if (bead.arc >= 0) {
        const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
        plan = std::abs(arc.sweep) * std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
        const double turn = arc.sweep < 0 ? -1 : 1;
        dx = -turn * (y - arc.center_y);
        dy = turn * (x - arc.center_x);
    }
    if (dx == 0 && dy == 0 && climb == 0) return {};
    long azimuth = dx == 0 && dy == 0 ? 0 : std::lround(std::atan2(dy, dx) * kDegrees);
    long elevation = std::lround(std::atan2(climb, plan) * kDegrees);
    if (azimuth < 0) {
        azimuth += 180;
        elevation = -elevation;
    }
    // atan2's half turn, and what the line above makes of it: back along x.
    if (azimuth == 180) {
        azimuth = 0;
        elevation = -elevation;
    }
    if (elevation == -90) elevation = 90;
    return {static_cast<std::int16_t>(azimuth), static_cast<std::int16_t>(elevation)};
}

}  // namespace stratum::mechanics
