#include "voxelize/beads/local_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::voxelize {

bool curved(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    if (bead.arc < 0) return false;
    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    return std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y) > 0 &&
           std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y) > 0;
}

LocalLine localLine(const gcode::Bead& bead, double half_flat, double x, double y, double half_extent, double scale) {
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    const double length = std::sqrt(dx * dx + dy * dy);
    // A path of no length is a point: its direction is arbitrary.
    const double ux = length > 0 ? dx / length : 1.0;
    const double uy = length > 0 ? dy / length : 0.0;
    const double px = x - bead.x0;
    const double py = y - bead.y0;
    const double along = ux * px + uy * py;
    const double extent = half_extent * (std::abs(ux) + std::abs(uy));
    LocalLine line{};
    line.nx = static_cast<float>(-uy);
    line.ny = static_cast<float>(ux);
    line.n0 = static_cast<float>((ux * py - uy * px) * scale);
    line.ux = static_cast<float>(ux);
    line.uy = static_cast<float>(uy);
    line.lo = static_cast<float>(-along * scale);
    line.hi = static_cast<float>((length - along) * scale);
    line.half_flat = static_cast<float>(half_flat * scale);
    line.spans = along >= extent && length - along >= extent;
    return line;
}

LocalTaper localTaper(const gcode::Bead& bead, const EndFlats& flats, double x, double y, double half_extent,
                      double scale) {
    LocalTaper taper{};
    taper.line = localLine(bead, std::max(flats.start, flats.end), x, y, half_extent, scale);
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    const double length = std::sqrt(dx * dx + dy * dy);
    const double slope = (flats.end - flats.start) / length;
    // From the section nearest to the column, so that no long way is multiplied by the slope in floats.
    const double near = std::clamp(((x - bead.x0) * dx + (y - bead.y0) * dy) / length, 0.0, length);
    taper.flat = static_cast<float>((flats.start + slope * near) * scale);
    taper.flat_at = near == 0 ? taper.line.lo : near == length ? taper.line.hi : 0.0F;
    taper.slope = static_cast<float>(slope);
    taper.lean = static_cast<float>(slope / std::sqrt(1 - slope * slope));
    return taper;
}

LocalArc localArc(const gcode::Bead& bead, const gcode::Arc& arc, double half_flat, double x, double y,
                  double half_extent, double scale) {
    const double from_x = bead.x0 - arc.center_x;
    const double from_y = bead.y0 - arc.center_y;
    const double to_x = bead.x1 - arc.center_x;
    const double to_y = bead.y1 - arc.center_y;
    const double from = std::hypot(from_x, from_y);
    const double to = std::hypot(to_x, to_y);
    const double radius = 0.5 * (from + to);
    const double vx = x - arc.center_x;
    const double vy = y - arc.center_y;
    const double v = std::hypot(vx, vy);
    const double turn = arc.sweep < 0 ? -1.0 : 1.0;
    const double ax = from_x / from;
    const double ay = from_y / from;
    const double bx = to_x / to;
    const double by = to_y / to;
    const auto world = [scale](double mm) { return static_cast<float>(mm * scale); };
    LocalArc local{};
    local.near_center = v < 4 * half_extent;
    if (!local.near_center) {
        local.ex = static_cast<float>(vx / v);
        local.ey = static_cast<float>(vy / v);
        local.k = static_cast<float>(1 / (v * scale));
    }
    local.rho0 = world(v - radius);
    local.vx = world(vx);
    local.vy = world(vy);
    local.radius = world(radius);
    // The ends of the path are on the circle of the mean radius; see gcode::Arc.
    local.start_x = world(radius * ax - vx);
    local.start_y = world(radius * ay - vy);
    local.end_x = world(radius * bx - vx);
    local.end_y = world(radius * by - vy);
    local.sx = static_cast<float>(-turn * ay);
    local.sy = static_cast<float>(turn * ax);
    local.s0 = world(turn * (ax * vy - ay * vx));
    local.tx = static_cast<float>(turn * by);
    local.ty = static_cast<float>(-turn * bx);
    local.t0 = world(turn * (vx * by - vy * bx));
    local.half_flat = world(half_flat);
    local.wide = std::abs(arc.sweep) > std::numbers::pi;
    local.full = std::abs(arc.sweep) >= 2 * std::numbers::pi;
    return local;
}

}  // namespace stratum::voxelize
