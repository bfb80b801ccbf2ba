#include "mechanics/bead_direction.h"

#include <cmath>
#include <numbers>

namespace stratum::mechanics {

BeadDirection directionAt(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const auto [dx, dy, climb] = gcode::pathDirection(toolpath, bead, x, y);
    const double plan = std::hypot(dx, dy);
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
