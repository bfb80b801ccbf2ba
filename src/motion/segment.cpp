#include "motion/segment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::motion {
namespace {

using gcode::ArcRule;
using gcode::CornerRule;

constexpr double kNoMotion = 1e-9;  // mm: Klipper's
constexpr double kMostChords = 1e5;

ArcRule arcRule(const gcode::MachineLimits& limits) {
    if (limits.arcs != ArcRule::unknown) return limits.arcs;
    switch (limits.rule) {
        case CornerRule::corner_velocity:
            return ArcRule::klipper;
        case CornerRule::junction_deviation:
        case CornerRule::marlin_jerk:
            return ArcRule::marlin;
        case CornerRule::reprap_jerk:
            return ArcRule::reprap;
        default:
            return ArcRule::unknown;
    }
}

// The number of chords of an arc.
double chordsOf(const gcode::Move& move, double radius, const gcode::MachineLimits& limits) {
    const double flat = radius * std::abs(move.sweep);
    double chords = 0;
    switch (arcRule(limits)) {
        case ArcRule::klipper:
            chords = std::floor(std::hypot(flat, move.delta[2]) / limits.arc_resolution);
            break;
        case ArcRule::marlin: {
            // Marlin 2: a millimetre at most, 72 to a full circle, but not below a tenth of a millimetre.
            constexpr double kLongest = 1;
            constexpr double kShortest = 0.1;
            constexpr double kOfACircle = 72;
            chords = std::max(std::floor(flat / kLongest),
                              std::ceil(kOfACircle * std::abs(move.sweep) / (2 * std::numbers::pi) - 1e-6));
            if (flat > chords * kLongest) chords = std::ceil(flat / kLongest);
            if (flat < chords * kShortest) chords = std::floor(flat / kShortest);
            break;
        }
        case ArcRule::reprap: {
            // RepRapFirmware 3: at most 5 um beside the arc, and at most 200 chords a second.
            const double chord = std::clamp(std::min(std::sqrt(8 * radius * 0.005), move.speed / 200), 0.02, 1.0);
            chords = std::floor(flat / chord + 0.8);
            break;
        }
        case ArcRule::unknown:
            chords = std::floor(std::hypot(flat, move.delta[2]));  // of a millimetre
    }
    return std::clamp(chords, 1.0, kMostChords);
}

// BambuStudio's GCodeProcessor (process_G2_G3) has an arc in one piece, with its tangents at both ends.
void takeWholeArc(const gcode::Move& move, Segment segment, const std::function<void(const Segment&)>& take) {
    const double radius = std::hypot(move.center.x, move.center.y);
    const double flat = radius * std::abs(move.sweep);
    segment.travels = true;
    segment.whole_arc = true;
    segment.radius = radius;
    segment.length = std::hypot(flat, move.delta[2]);
    if (!(segment.length > kNoMotion) || !(radius > 0)) return;
    const double share = flat / segment.length;
    const double turn = move.sweep < 0 ? -1 : 1;
    // Square to the way from the center, which is minus `center` at the start.
    const double x = turn * move.center.y / radius;
    const double y = -turn * move.center.x / radius;
    const double cosine = std::cos(move.sweep);
    const double sine = std::sin(move.sweep);
    segment.direction = {share * x, share * y, move.delta[2] / segment.length, move.delta[3] / segment.length};
    segment.exit = {cosine * x - sine * y, sine * x + cosine * y};
    take(segment);
}

void cutArc(const gcode::Move& move, const gcode::MachineLimits& limits, Segment segment,
            const std::function<void(const Segment&)>& take) {
    const auto& d = move.delta;
    const double radius = std::hypot(move.center.x, move.center.y);
    const double chords = chordsOf(move, radius, limits);
    segment.radius = radius;
    double x = 0;
    double y = 0;
    for (int i = 1; i <= static_cast<int>(chords); ++i) {
        // From the begin, as the firmwares do; the last chord ends at the target, also if that is beside the circle.
        const double angle = move.sweep * i / chords;
        const bool last = i == static_cast<int>(chords);
        const double cosine = std::cos(angle);
        const double sine = std::sin(angle);
        const double next_x = last ? d[0] : move.center.x * (1 - cosine) + move.center.y * sine;
        const double next_y = last ? d[1] : move.center.y * (1 - cosine) - move.center.x * sine;
        const std::array<double, gcode::kMotionAxes> step{next_x - x, next_y - y, d[2] / chords, d[3] / chords};
        segment.start = {move.start[0] + x, move.start[1] + y, move.start[2] + d[2] * (i - 1) / chords};
        x = next_x;
        y = next_y;
        const double path = std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
        segment.travels = path > kNoMotion;
        segment.length = segment.travels ? path : std::abs(step[3]);
        if (!(segment.length > kNoMotion)) continue;
        for (std::size_t axis = 0; axis < gcode::kMotionAxes; ++axis)
            segment.direction[axis] = step[axis] / segment.length;
        segment.exit = {segment.direction[0], segment.direction[1]};
        segment.arc_rest = radius * std::abs(move.sweep) * (1 - i / chords);
        take(segment);
    }
}

}  // namespace

void cutMove(const gcode::Move& move, const gcode::MachineLimits& limits,
             const std::function<void(const Segment&)>& take) {
    const auto& d = move.delta;
    Segment segment;
    segment.bead = move.bead;
    segment.line = move.line;
    segment.travel = move.travel;
    segment.filament_area = move.filament_area;
    segment.pressure_advance = limits.pressure_advance;
    segment.speed = segment.asked = move.speed;
    segment.start = move.start;
    if (move.sweep != 0 && limits.rule == gcode::CornerRule::bambu_jerk) return takeWholeArc(move, segment, take);
    if (move.sweep != 0) return cutArc(move, limits, segment, take);
    const double path = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    segment.travels = path > kNoMotion;
    segment.length = segment.travels ? path : std::abs(d[3]);
    if (!(segment.length > kNoMotion)) return;
    for (std::size_t axis = 0; axis < gcode::kMotionAxes; ++axis) segment.direction[axis] = d[axis] / segment.length;
    segment.exit = {segment.direction[0], segment.direction[1]};
    take(segment);
}

}  // namespace stratum::motion
