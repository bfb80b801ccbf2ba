#include "gcode/machine/motion_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kDefaultSpeed = 25;         // mm/s before the first F: Marlin's and Klipper's
constexpr double kSlowest = 0.01;            // mm/s; no firmware goes slower
constexpr double kStandstill = 1e-12;        // mm
constexpr double kLongestRetraction = 1000;  // mm
constexpr std::array<char, kMotionAxes> kLetters{'X', 'Y', 'Z', 'E'};

/// s of a filament.
double timeOf(const std::vector<double>& times, std::size_t tool) {
    return times.empty() ? 0.0 : times[std::min(tool, times.size() - 1)];
}

// Commands that stop the machine for an unknown time: homing, probing, heating, pauses.
bool rests(const Command& command) {
    if (command.letter == 'G') return command.code == 28 || command.code == 29 || command.code == 30;
    constexpr std::array kCodes{0, 1, 25, 109, 190, 226, 400, 600};
    return std::find(kCodes.begin(), kCodes.end(), command.code) != kCodes.end();
}

std::optional<Stop> stopOf(const Command& command) {
    switch (command.code) {
        case 0:
        case 1:
        case 25:
        case 226:
        case 601:
            return Stop::pause;
        case 400:  // Bambu's pause for the user
            return command.hasValue('U') ? std::optional(Stop::pause) : std::nullopt;
        case 600:
            return Stop::filament_change;
        default:
            return std::nullopt;
    }
}

}  // namespace

MotionRecorder::MotionRecorder(MotionSink& sink, MachineSettings settings, WarningLog& warnings, bool for_flow)
    : sink_(sink), settings_(std::move(settings)), limits_(settings_.limits), warnings_(warnings), for_flow_(for_flow) {
    sink_.limits(limits_);
}

void MotionRecorder::change(Limit limit, double value, std::uint32_t line) {
    valueOf(limits_, limit) = value;
    LimitOrigin& origin = settings_.origins[limit];
    if (origin.changes++ == 0) origin.first_change = line;
}

bool MotionRecorder::take(Limit limit, std::string_view what, double value, std::uint32_t line) {
    const Bounds bounds = boundsOf(limit);
    if (value >= bounds.least && value <= bounds.most) {
        change(limit, value, line);
        return true;
    }
    if (value > bounds.most && std::isfinite(value)) {
        warnings_.add(fmt::format("{}{:g} is more than any machine has; {:g} is taken", what, value, bounds.most),
                      line);
        change(limit, bounds.most, line);
        return true;
    }
    warnings_.add(fmt::format("{}{:g} is no limit that a machine can move by; ignored", what, value), line);
    return false;
}

void MotionRecorder::byAxis(const Command& command, Limit first, double scale, std::uint32_t line) {
    // Of another extruder than the first, whose limits alone are planned by; T of M205 is a speed.
    if (command.code != 205 && command.hasValue('T') && command.value('T') != 0) return;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
        if (command.hasValue(kLetters[axis]))
            take(ofAxis(first, axis), fmt::format("M{} {}", command.code, kLetters[axis]),
                 command.value(kLetters[axis]) * scale, line);
}

void MotionRecorder::setAcceleration(const Command& command, double unit, std::uint32_t line) {
    const auto read = [&](char letter, Limit limit, double bound) {
        if (command.hasValue(letter) &&
            take(limit, fmt::format("M204 {}", letter), command.value(letter) * unit, line) && bound > 0)
            valueOf(limits_, limit) = std::min(valueOf(limits_, limit), bound);
    };
    if (isKlipper()) {
        // It has one acceleration: S, or the lower of P and T, which it refuses alone.
        const bool both = command.hasValue('P') && command.hasValue('T');
        if (!command.hasValue('S') && !both)
            return warnings_.add("M204 without S, or P and T together: Klipper refuses it; ignored", line);
        const char letter = command.hasValue('S') ? 'S' : command.value('P') < command.value('T') ? 'P' : 'T';
        read(letter, Limit::printing, 0);
        limits_.travel = limits_.printing;
    } else if (command.hasValue('S')) {
        // The older form: printing and travel alike, and T is for retractions.
        read('S', Limit::printing, settings_.most_printing);
        read('S', Limit::travel, settings_.most_travel);
        read('T', Limit::retracting, 0);
    } else if (command.hasValue('P') || command.hasValue('R') || command.hasValue('T')) {
        read('P', Limit::printing, settings_.most_printing);
        read('R', Limit::retracting, 0);
        read('T', Limit::travel, settings_.most_travel);
    } else {
        warnings_.add("M204 without an acceleration (P, R, T or S); ignored", line);
    }
}

void MotionRecorder::suggest(CornerRule rule) {
    if (!settings_.rule_chosen) limits_.rule = rule;
}

void MotionRecorder::setCorners(const Command& command, double unit, std::uint32_t line) {
    byAxis(command, Limit::jerk, unit, line);
    // One X stands for the plane, as in legacy Marlin.
    const bool refused = !(command.value('X') * unit >= boundsOf(Limit::jerk).least);
    if (command.hasValue('X') && !command.hasValue('Y') && !refused)
        change(ofAxis(Limit::jerk, 1), limits_.jerk[0], line);
    if (command.hasValue('S')) take(Limit::least_printing_speed, "M205 S", command.value('S') * unit, line);
    if (command.hasValue('T')) take(Limit::least_travel_speed, "M205 T", command.value('T') * unit, line);
    if (!command.hasValue('J')) return;
    // J0 is written for machines with classic jerk.
    if (command.value('J') == 0) return suggest(settings_.limits.rule);
    if (take(Limit::junction_deviation, "M205 J", command.value('J') * unit, line))
        suggest(CornerRule::junction_deviation);
}

void MotionRecorder::setRetraction(const Command& command, Retraction& retraction, double unit) {
    if (command.hasValue('S')) retraction.length = std::clamp(command.value('S') * unit, 0.0, kLongestRetraction);
    if (command.hasValue('F')) retraction.speed = std::max(command.value('F') * unit / 60, 0.0);
}

void MotionRecorder::retraction(const RetractionChange& change) {
    if (change.length) retract_.length = std::clamp(*change.length, 0.0, kLongestRetraction);
    if (change.speed) retract_.speed = std::max(*change.speed, 1.0);
    if (change.extra) recover_.length = std::clamp(*change.extra, 0.0, kLongestRetraction);
    if (change.recovery_speed) recover_.speed = std::max(*change.recovery_speed, 1.0);
    retracted_ = false;
}

void MotionRecorder::runRetraction(const Retraction& retraction, double sign, std::uint32_t line) {
    if (!(retraction.length > 0)) return;
    Move move;
    move.start = {place_.x, place_.y, place_.z};
    move.delta[3] = sign * retraction.length;
    move.filament_area = filament_area_;
    move.speed = retraction.speed > 0 ? std::max(retraction.speed, kSlowest) : kDefaultSpeed;
    move.line = line;
    sink_.move(move);
}

void MotionRecorder::dwell(const Command& command, std::uint32_t line) {
    double seconds = 0;
    if (command.hasValue('P')) seconds = command.value('P') / 1000;
    if (command.hasValue('S') && !isKlipper()) seconds = command.value('S');
    if (!(seconds >= 0)) return warnings_.add("G4 with a time below zero; ignored", line);
    if (seconds > kLongestWait) {
        warnings_.add(fmt::format("G4 of {:g} s; {:g} are taken", seconds, kLongestWait), line);
        seconds = kLongestWait;
    }
    sink_.wait(seconds);
}

void MotionRecorder::home(const Command& command, std::uint32_t line) {
    const bool all = !command.has('X') && !command.has('Y') && !command.has('Z');
    const Point from = place_;
    Point to = from;
    if (all || command.has('X')) to.x = 0;
    if (all || command.has('Y')) to.y = 0;
    if (all || command.has('Z')) to.z = 0;
    move(from, to, std::nullopt, 0, filament_area_, speed_, Move::kNoBead, line);
}

void MotionRecorder::command(const Command& command, double unit, std::uint32_t line) {
    if (command.letter == 'G') {
        if (command.code == 4) return dwell(command, line);
        // G10 with P or L sets offsets; both retract once only.
        if (command.code == 10 && !command.hasValue('P') && !command.hasValue('L') && !retracted_) {
            retracted_ = true;
            return runRetraction(retract_, -1, line);
        }
        if (command.code == 11 && retracted_) {
            retracted_ = false;
            // Marlin's M208 S is what comes on top.
            return runRetraction(
                {retract_.length + recover_.length, recover_.speed > 0 ? recover_.speed : retract_.speed}, 1, line);
        }
        const bool by_slicer = limits_.rule == CornerRule::slicer_jerk || limits_.rule == CornerRule::bambu_jerk;
        if (command.code == 28 && by_slicer) return home(command, line);
        if (rests(command)) sink_.wait(0);
        return;
    }
    if (command.letter != 'M') return;
    if (const auto stop = stopOf(command)) sink_.stop(*stop, line);
    const double per_second = settings_.feedrate_per_minute ? 1.0 / 60 : 1;
    if (isKlipper() && (command.code == 201 || command.code == 203 || command.code == 205 || command.code == 207 ||
                        command.code == 208 || command.code == 566))
        return warnings_.add(fmt::format("M{}: Klipper has no such command; ignored", command.code), line);
    switch (command.code) {
        case 92:
            byAxis(command, Limit::steps_per_mm, 1 / unit, line);
            break;
        case 201:
            if (command.subcode != 0) return;  // M201.1 of RepRapFirmware: of special moves alone
            byAxis(command, Limit::acceleration, unit, line);
            break;
        case 203:
            byAxis(command, Limit::speed, unit * per_second, line);
            break;
        case 204:
            setAcceleration(command, unit, line);
            break;
        case 205:
            setCorners(command, unit, line);
            break;
        case 207:
            return setRetraction(command, retract_, unit);
        case 208:
            return setRetraction(command, recover_, unit);
        case 566:
            byAxis(command, Limit::jerk, 1.0 / 60, line);
            if (command.hasValue('P')) limits_.jerk_policy = command.value('P') != 0 ? 1 : 0;
            break;
        case 572:
            if (command.hasValue('S')) pressureAdvance("M572 S", command.value('S'), line);
            return;
        case 900:
            if (command.hasValue('K')) pressureAdvance("M900 K", command.value('K'), line);
            return;
        default:
            if (rests(command)) sink_.wait(command.code == 400 ? limits_.wait_after_m400 : 0);
            return;
    }
    sink_.limits(limits_);
}

void MotionRecorder::velocityLimit(const VelocityLimit& limit, std::uint32_t line) {
    if (limit.velocity) take(Limit::path_speed, "SET_VELOCITY_LIMIT VELOCITY=", *limit.velocity, line);
    if (limit.acceleration && take(Limit::printing, "SET_VELOCITY_LIMIT ACCEL=", *limit.acceleration, line))
        change(Limit::travel, limits_.printing, line);
    if (limit.corner_velocity &&
        take(Limit::corner_velocity, "SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=", *limit.corner_velocity, line) &&
        settings_.states_jerk) {
        // OrcaSlicer's estimate takes it for the jerk in the plane.
        change(ofAxis(Limit::jerk, 0), limits_.corner_velocity, line);
        change(ofAxis(Limit::jerk, 1), limits_.corner_velocity, line);
    }
    if (limit.cruise_ratio)
        take(Limit::cruise_ratio, "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=", *limit.cruise_ratio, line);
    // Only Klipper has this command.
    if (!settings_.states_jerk) suggest(CornerRule::corner_velocity);
    sink_.limits(limits_);
}

void MotionRecorder::changeTool(std::size_t from, std::size_t to, std::uint32_t line) {
    if (!settings_.extruders.empty()) {
        changeFilament(to, line);
        return;
    }
    if (from == to) return;
    sink_.stop(Stop::tool_change, line);
    const bool loaded = changed_ || !settings_.parked;
    changed_ = true;
    sink_.wait((loaded ? timeOf(settings_.unload, from) : 0.0) + timeOf(settings_.load, to) + settings_.change);
}

void MotionRecorder::changeFilament(std::size_t to, std::uint32_t line) {
    const std::vector<std::size_t>& extruders = settings_.extruders;
    const std::size_t extruder = to < extruders.size() ? extruders[to] : extruders.front();
    const std::optional<std::size_t> before = extruder_;
    const auto [held, empty] = filaments_.try_emplace(extruder, to);
    if (before == extruder && !empty && held->second == to) return;
    sink_.stop(Stop::tool_change, line);
    double seconds = before && before != extruder ? std::max(settings_.change, settings_.extruder_change) : 0.0;
    if (empty || held->second != to) seconds += timeOf(settings_.load, to);
    if (!empty && held->second != to) seconds += timeOf(settings_.unload, held->second);
    extruder_ = extruder;
    held->second = to;
    sink_.wait(seconds);
}

void MotionRecorder::pressureAdvance(std::string_view what, double seconds, std::uint32_t line) {
    // Linear Advance 1.0 counts K in other units, from about 10 up; nothing tells what it means for the flow.
    if (!(seconds >= 0 && seconds <= kLongestAdvance)) {
        if (for_flow_)
            warnings_.add(fmt::format("{}{:g} is no pressure advance in seconds (0 to {:g}); ignored", what, seconds,
                                      kLongestAdvance),
                          line);
        return;
    }
    // Klipper stops to switch the smoothing of the extruder on or off.
    if (isKlipper() && (seconds > 0) != (limits_.pressure_advance > 0)) sink_.wait(0);
    limits_.pressure_advance = seconds;
    sink_.limits(limits_);
}

void MotionRecorder::move(const Point& from, const Point& to, const std::optional<Arc>& arc, double filament,
                          double filament_area, double speed, std::uint32_t bead, std::uint32_t line) {
    Move move;
    move.start = {from.x, from.y, from.z};
    place_ = to;
    speed_ = speed;
    move.filament_area = filament_area_ = filament_area;
    move.delta = {to.x - from.x, to.y - from.y, to.z - from.z, filament};
    if (arc) {
        move.sweep = arc->sweep;
        move.center = {arc->center_x - from.x, arc->center_y - from.y};
    }
    const auto moves = [](double delta) { return std::abs(delta) > kStandstill; };
    if (!arc && std::none_of(move.delta.begin(), move.delta.end(), moves)) return;
    move.speed = speed > 0 ? std::max(speed, kSlowest) : kDefaultSpeed;
    move.bead = bead;
    move.line = line;
    sink_.move(move);
}

void MotionRecorder::finish() {
    settings_.origins.rule = limits_.rule;
    sink_.origin(settings_.origins);
    if (!isKlipper()) return;
    std::size_t assumed = 0;
    for (std::size_t n = 0; n < kLimitCount; ++n) {
        const auto limit = static_cast<Limit>(n);
        const LimitOrigin::Kind kind = settings_.origins[limit].kind;
        const bool given = kind == LimitOrigin::Kind::printer || kind == LimitOrigin::Kind::firmware;
        if (!given && isUsed(limit, settings_.origins)) ++assumed;
    }
    if (assumed > 0)
        warnings_.add(fmt::format("Klipper's limits are in its own configuration: {} of them are assumed for the times "
                                  "(--summary lists them); give the printer's printer.cfg",
                                  assumed),
                      1);
}

}  // namespace stratum::gcode
