#include "voxelize/beads/local_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::voxelize {

std::optional<gcode::PlanPath> arcOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    if (bead.arc < 0) return std::nullopt;
    const gcode::PlanPath path(toolpath, bead);
    return path.straight() ? std::nullopt : std::optional(path);
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

LocalArc localArc(const gcode::PlanPath& path, double half_flat, double x, double y, double half_extent, double scale) {
    const double radius = path.radius();
    const auto [ax, ay] = path.startSide();
    const auto [bx, by] = path.endSide();
    const double vx = x - path.center().x;
    const double vy = y - path.center().y;
    const double v = std::hypot(vx, vy);
    const double turn = path.turn() < 0 ? -1.0 : 1.0;
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
    local.wide = std::abs(path.turn()) > std::numbers::pi;
    local.full = std::abs(path.turn()) >= 2 * std::numbers::pi;
    return local;
}

}  // namespace stratum::voxelize
