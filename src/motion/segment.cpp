#include "motion/segment.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {
namespace {

constexpr double kNoMotion = 1e-12;  // mm
constexpr double kMostPieces = 1e5;

// Limits the programmed speed and acceleration to those of the axes.
void limitAxes(const gcode::MachineLimits& limits, Segment& segment) {
    for (std::size_t axis = 0; axis < gcode::kMotionAxes; ++axis) {
        const double share = std::abs(segment.direction[axis]);
        if (share * segment.speed > limits.speed[axis]) segment.speed = limits.speed[axis] / share;
        if (share * segment.acceleration > limits.acceleration[axis])
            segment.acceleration = limits.acceleration[axis] / share;
    }
}

double pathLength(const gcode::Move& move) {
    const auto& d = move.delta;
    if (move.sweep == 0) return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double radius =
        0.5 * (std::hypot(move.center.x, move.center.y) + std::hypot(d[0] - move.center.x, d[1] - move.center.y));
    return std::hypot(radius * move.sweep, d[2]);
}

}  // namespace

void cutMove(const gcode::Move& move, const gcode::MachineLimits& limits,
             const std::function<void(const Segment&)>& take) {
    const auto& d = move.delta;
    Segment segment;
    segment.bead = move.bead;
    segment.line = move.line;
    segment.filament_area = move.filament_area;
    segment.pressure_advance = limits.pressure_advance;
    segment.curved = move.sweep != 0;
    const double path = pathLength(move);
    segment.travels = path > kNoMotion;
    const double length = segment.travels ? path : std::abs(d[3]);
    if (!(length > kNoMotion)) return;
    const bool extrudes = d[3] != 0;
    const double least = extrudes ? limits.least_printing_speed : limits.least_travel_speed;
    const double speed = std::min(std::max(move.speed, least), segment.travels ? limits.path_speed : move.speed);
    const double acceleration = !segment.travels ? limits.retracting : extrudes ? limits.printing : limits.travel;
    const double pieces = move.sweep == 0 ? 1 : std::clamp(std::floor(length / kArcPiece), 1.0, kMostPieces);
    segment.length = length / pieces;
    const double chord = move.sweep == 0 ? 0 : std::hypot(move.center.x, move.center.y);
    const double plan = move.sweep == 0 ? 0 : std::sqrt(std::max(length * length - d[2] * d[2], 0.0)) / length;
    const double start = chord > 0 ? std::atan2(-move.center.y, -move.center.x) : 0;
    for (int i = 0; i < static_cast<int>(pieces); ++i) {
        segment.speed = segment.asked = speed;
        segment.acceleration = acceleration;
        segment.direction = {d[0] / length, d[1] / length, d[2] / length, d[3] / length};
        if (move.sweep != 0) {
            // The tangent in the middle of the piece, which is its chord's direction.
            const double angle = start + move.sweep * (i + 0.5) / pieces;
            segment.direction[0] = std::copysign(plan, move.sweep) * -std::sin(angle);
            segment.direction[1] = std::copysign(plan, move.sweep) * std::cos(angle);
        }
        limitAxes(limits, segment);
        take(segment);
    }
}

}  // namespace stratum::motion
