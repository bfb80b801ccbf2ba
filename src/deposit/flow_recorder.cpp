#include "deposit/flow_recorder.h"

#include <algorithm>
#include <cmath>

namespace stratum::deposit {
namespace {

// A flow this near to the commanded one is steady, as a fraction of it.
constexpr double kSteady = 1e-3;
constexpr int kRestSteps = 4;    // samples of a phase that lays nothing
constexpr double kClosed = 0.4;  // mm between the ends of a loop
constexpr int kHalvings = 40;
constexpr double kMostOozes = 16384;  // pieces of a phase of a travel
constexpr int kMostChanges = 8;       // between flowing and not, in one step

// Seconds after which constant acceleration from v0 to v1 in `seconds` has covered s mm.
double timeAt(double s, double v0, double v1, double seconds) {
    const double acceleration = (v1 - v0) / seconds;
    const double root = std::sqrt(std::max(v0 * v0 + 2 * acceleration * s, 0.0));
    const double sum = v0 + root;
    return sum > 0 ? std::min(2 * s / sum, seconds) : seconds;
}

// Places that divide a phase of this length, finer towards both ends, where the flow changes most.
template <typename Visit>
void forEachPlace(double length, double first, Visit visit) {
    double step = first;
    while (2 * step < length) {
        visit(step);
        step *= 2;
    }
    while (step > first) {
        step /= 2;
        if (length - step > 0.5 * length) visit(length - step);
    }
}

}  // namespace

double FlowRecorder::pressed(const Phase& phase, double t) const {
    const double fed = fed_ + (phase.a + 0.5 * phase.b * t) * t;
    // Without a lag there is nothing to advance.
    return phase.prints && lag_ > 0 ? fed + advance_now_ * (phase.a + phase.b * t) : fed;
}

double FlowRecorder::flowAt(const Phase& phase, double from, double pressure, double to) const {
    const double a = phase.a + phase.b * from + (phase.prints ? advance_now_ * phase.b : 0);
    const double t = to - from;
    return a + phase.b * (t - lag_) + (pressure / lag_ - a + phase.b * lag_) * std::exp(-t / lag_);
}

double FlowRecorder::flowOut(const Phase& phase, double from, double to) {
    const double before = record_.laid;
    // The first time at which `stops` holds, between one where it does not and one where it does.
    const auto firstTime = [](double low, double high, const auto& stops) {
        for (int n = 0; n < kHalvings; ++n) {
            const double middle = 0.5 * (low + high);
            (stops(middle) ? high : low) = middle;
        }
        return high;
    };
    for (int n = 0; n < kMostChanges && from < to; ++n) {
        const double pressure = pressed(phase, from) - record_.laid;
        if (!(lag_ > 0)) {
            record_.laid = std::max(record_.laid, pressed(phase, to));
            break;
        }
        if (pressure > 0) {
            const auto stopped = [&](double t) { return flowAt(phase, from, pressure, t) < 0; };
            const double end = stopped(to) ? firstTime(from, to, stopped) : to;
            const double rest = lag_ * std::max(flowAt(phase, from, pressure, end), 0.0);
            record_.laid = std::max(record_.laid, pressed(phase, end) - rest);
            from = end;
        } else {
            const auto flows = [&](double t) { return pressed(phase, t) > record_.laid; };
            if (!flows(to)) break;
            from = firstTime(from, to, flows);
        }
    }
    record_.fed = std::max(record_.fed, fed_ + (phase.a + 0.5 * phase.b * to) * to);
    return record_.laid - before;
}

void FlowRecorder::rest(double volume, bool in_plane, double time) {
    if (in_plane) {
        // Primed at a place from which the nozzle travels on.
        record_.purged += arrival_.volume;
        arrival_.volume = 0;
        travelled_ = true;
    }
    if (!(volume > 0)) return;
    if (travelled_ && !in_plane) {
        if (arrival_.volume == 0) arrival_.time = time;
        arrival_.volume += volume;
    } else {
        layAtEnd(volume, time);
    }
}

// At the end of the path up to now.
void FlowRecorder::layAtEnd(double volume, double time) {
    if (path_.empty()) {
        record_.purged += volume;
    } else if (!spots_.empty() && spots_.back().before == path_.size()) {
        spots_.back().volume += volume;
    } else {
        spots_.push_back({path_.size(), volume, time});
    }
}

void FlowRecorder::layPhase(const Phase& phase, const motion::Segment& segment) {
    const double length = 0.5 * (phase.v0 + phase.v1) * phase.seconds;
    double s_before = 0;
    double t_before = 0;
    const auto lay = [&](double s, double t) {
        FlowInterval one;
        one.bead = segment.bead;
        one.tapers = segment.radius == 0 && segment.direction[2] == 0;
        one.s0 = along_ + s_before;
        one.s1 = along_ + s;
        one.commanded = segment.direction[3] * segment.filament_area;
        one.volume = flowOut(phase, t_before, t);
        one.t0 = phase.start + t_before;
        one.t1 = phase.start + t;
        path_.push_back(one);
        s_before = s;
        t_before = t;
    };
    const double flow = lag_ > 0 ? (pressed(phase, 0) - record_.laid) / lag_ : phase.a;
    const bool constant = !(lag_ > 0) || (phase.b == 0 && std::abs(flow - phase.a) <= kSteady * phase.a);
    if (!constant)
        forEachPlace(length, 0.25 * nozzle_, [&](double s) { lay(s, timeAt(s, phase.v0, phase.v1, phase.seconds)); });
    lay(length, phase.seconds);
    along_ += length;
}

// What flows out on a travel, in short pieces of it.
void FlowRecorder::ooze(const Phase& phase, const motion::Segment& segment) {
    rest(0, true, phase.start);
    const double length = 0.5 * (phase.v0 + phase.v1) * phase.seconds;
    const double step = length / std::clamp(std::ceil(length / kOozeStep), 1.0, kMostOozes);
    const auto at = [&](int axis, double s) {
        const auto n = static_cast<std::size_t>(axis);
        return segment.start[n] + segment.direction[n] * (phase.along + s);
    };
    double s_before = 0;
    double t_before = 0;
    while (t_before < phase.seconds) {
        double s = s_before + step;
        const bool last = strings_->broken() || s >= length - 0.5 * step;
        if (last) s = length;
        const double t = last ? phase.seconds : timeAt(s, phase.v0, phase.v1, phase.seconds);
        const double volume = flowOut(phase, t_before, t);
        strings_->ooze({at(0, s_before), at(1, s_before), at(0, s), at(1, s), volume, phase.start + t_before,
                        t - t_before, moves_},
                       path_.back().bead);
        s_before = s;
        t_before = t;
    }
}

void FlowRecorder::endTravel(double time) {
    if (!strings_) return;
    const StringRecorder::Rest left = strings_->finish(record_);
    if (left.before > 0) layAtEnd(left.before, path_.back().t1);
    if (arrival_.volume == 0) arrival_.time = time;
    arrival_.volume += left.after;
}

void FlowRecorder::runPhase(const Phase& phase, const motion::Segment& segment) {
    if (!(phase.seconds > 0)) return;
    if (phase.prints) {
        layPhase(phase, segment);
    } else {
        const bool in_plane = segment.travels && (segment.direction[0] != 0 || segment.direction[1] != 0);
        if (strings_ && in_plane && !path_.empty()) {
            ooze(phase, segment);
        } else {
            for (int n = 0; n < kRestSteps; ++n) {
                const double t = phase.seconds * (n + 1) / kRestSteps;
                rest(flowOut(phase, phase.seconds * n / kRestSteps, t), in_plane, phase.start + t);
            }
        }
    }
    fed_ += (phase.a + 0.5 * phase.b * phase.seconds) * phase.seconds;
}

void FlowRecorder::piece(const motion::PlannedPiece& piece) {
    const motion::Segment& segment = piece.segment;
    const motion::Trapezoid& speed = piece.speed;
    const bool prints = segment.bead != gcode::Move::kNoBead && segment.travels;
    advance_now_ = advance_.value_or(segment.pressure_advance);
    record_.longest_advance = std::max(record_.longest_advance, advance_now_);
    const double share = segment.direction[3] * segment.filament_area;  // mm^3 per mm of path
    if (prints) {
        if (travelled_) {
            endTravel(piece.start);
            endPath();
            if (arrival_.volume > 0) spots_.push_back({0, arrival_.volume, arrival_.time});
            arrival_.volume = 0;
            travelled_ = false;
        }
        if (path_.empty() || path_.back().bead != segment.bead) along_ = 0;
        if (record_.filament_area == 0) record_.filament_area = segment.filament_area;
        record_.fed_to_beads += share * segment.length;
        path_x_ += segment.direction[0] * segment.length;
        path_y_ += segment.direction[1] * segment.length;
        if (strings_) {
            const auto end = [&](std::size_t axis) {
                return segment.start[axis] + segment.direction[axis] * segment.length;
            };
            strings_->print(segment.start[0], segment.start[1], end(0), end(1), end(2), 0.5 * nozzle_);
        }
    }
    ++moves_;
    double start = piece.start;
    double along = 0;
    const auto run = [&](double seconds, double v0, double v1) {
        if (!(seconds > 0)) return;
        runPhase({start, seconds, share * v0, share * (v1 - v0) / seconds, v0, v1, prints, along}, segment);
        start += seconds;
        along += 0.5 * (v0 + v1) * seconds;
    };
    run(speed.rising, speed.entry, speed.peak);
    run(speed.cruising, speed.peak, speed.peak);
    run(speed.falling, speed.peak, speed.exit);
}

void FlowRecorder::wait(double start, double seconds) { runPhase({start, seconds, 0, 0, 0, 0, false}, {}); }

void FlowRecorder::endPath() {
    if (!path_.empty()) {
        // Slicers end a loop a fraction of the nozzle's width before its begin.
        const bool closed = path_.front().bead != path_.back().bead && std::hypot(path_x_, path_y_) < kClosed;
        dividePath(path_, spots_, closed, nozzle_, record_);
    } else {
        for (const PathSpot& spot : spots_) record_.purged += spot.volume;
    }
    path_.clear();
    spots_.clear();
    path_x_ = path_y_ = 0;
}

FlowRecord FlowRecorder::finish() {
    endTravel(0);
    endPath();
    record_.purged += arrival_.volume;
    return std::move(record_);
}

}  // namespace stratum::deposit
