#include "deposit/flow_recorder.h"

#include <algorithm>
#include <cmath>

namespace stratum::deposit {
namespace {

// A spot of at most this share of what lies in the cell beside it is no disc of its own.
constexpr double kSmallSpot = 0.25;
// Sections this near to each other are one, as a fraction: a long arc at a steady flow is one interval, not thousands.
constexpr double kSameSection = 1e-6;
// Intervals in a part: each one more is a new fit to all of them.
constexpr std::size_t kMostInPart = 64;

// Neighbouring intervals over which the flow is averaged.
struct Cell {
    std::size_t first, last;  // intervals [first, last)
    double length, volume;
};

std::vector<Cell> averageOver(std::span<const FlowInterval> path, double least) {
    std::vector<Cell> cells;
    Cell cell{0, 0, 0, 0};
    for (std::size_t n = 0; n < path.size(); ++n) {
        cell.last = n + 1;
        cell.length += path[n].s1 - path[n].s0;
        cell.volume += path[n].volume;
        if (cell.length < least) continue;
        cells.push_back(cell);
        cell = {n + 1, n + 1, 0, 0};
    }
    if (cell.first == cell.last) return cells;
    if (cells.empty()) return {cell};
    cells.back().last = cell.last;
    cells.back().length += cell.length;
    cells.back().volume += cell.volume;
    return cells;
}

void placeSpots(std::span<const FlowInterval> path, std::span<const PathSpot> spots, bool closed,
                std::vector<Cell>& cells, std::vector<FlowSpot>& placed) {
    auto cell = cells.begin();
    for (const PathSpot& spot : spots) {
        while (std::next(cell) != cells.end() && cell->last <= spot.before) ++cell;
        if (spot.volume <= kSmallSpot * cell->volume) {
            cell->volume += spot.volume;
            continue;
        }
        const bool at_end = spot.before == path.size();
        const bool inside = closed || (spot.before > 0 && !at_end);
        placed.push_back({path[at_end ? spot.before - 1 : spot.before].bead, at_end, inside, spot.volume, spot.time});
    }
}

bool sameFlow(const FlowInterval& a, const FlowInterval& b) {
    const double one = a.volume * (b.s1 - b.s0);
    const double other = b.volume * (a.s1 - a.s0);
    return a.bead == b.bead && std::abs(one - other) <= kSameSection * std::abs(one);
}

// The intervals of each bead with the flow of their cells; those of one bead and cell become one.
std::vector<FlowInterval> averaged(std::span<const FlowInterval> path, const std::vector<Cell>& cells) {
    std::vector<FlowInterval> all;
    for (const Cell& cell : cells) {
        const std::size_t begin = all.size();
        for (std::size_t n = cell.first; n < cell.last; ++n) {
            if (all.size() > begin && all.back().bead == path[n].bead) {
                all.back().s1 = path[n].s1;
                all.back().t1 = path[n].t1;
            } else {
                all.push_back(path[n]);
            }
        }
        for (std::size_t n = begin; n < all.size(); ++n)
            all[n].volume = cell.volume * (all[n].s1 - all[n].s0) / cell.length;
        if (begin > 0 && sameFlow(all[begin - 1], all[begin])) {
            FlowInterval& before = all[begin - 1];
            before.s1 = all[begin].s1;
            before.t1 = all[begin].t1;
            before.volume += all[begin].volume;
            all.erase(all.begin() + static_cast<std::ptrdiff_t>(begin));
        }
    }
    return all;
}

struct Fit {
    double volume, growth;
    bool good;
};

// The line through the sections of neighbouring intervals that keeps their volume, by least squares.
Fit fitLine(std::span<const FlowInterval> parts) {
    const double start = parts.front().s0;
    const double length = parts.back().s1 - start;
    const double middle = start + 0.5 * length;
    double volume = 0;
    double moment = 0;
    double span2 = 0;
    for (const FlowInterval& one : parts) {
        const double at = 0.5 * (one.s0 + one.s1) - middle;
        volume += one.volume;
        moment += one.volume * at;
        span2 += (one.s1 - one.s0) * at * at;
    }
    const double mean = volume / length;
    const auto within = [&](double slope, double tolerance) {
        return std::all_of(parts.begin(), parts.end(), [&](const FlowInterval& one) {
            const double at = 0.5 * (one.s0 + one.s1) - middle;
            return std::abs(one.volume / (one.s1 - one.s0) - mean - slope * at) <= tolerance * one.commanded;
        });
    };
    // One section where it serves as well.
    if (parts.size() == 1 || within(0, 0.5 * kSectionTolerance)) return {volume, 0, true};
    if (!parts.front().tapers) return {volume, 0, within(0, kSectionTolerance)};
    const double slope = moment / span2;
    return {volume, slope * length, within(slope, kSectionTolerance)};
}

void divideBead(std::span<const FlowInterval> parts, FlowRecord& record) {
    const double length = parts.back().s1;
    if (!(length > 0)) return;  // nothing is laid on it either
    while (!parts.empty()) {
        std::size_t count = 1;
        Fit fit = fitLine(parts.first(1));
        for (std::size_t more = 2; more <= std::min(parts.size(), kMostInPart); ++more) {
            const Fit longer = fitLine(parts.first(more));
            if (!longer.good) break;
            fit = longer;
            count = more;
        }
        const FlowInterval& first = parts.front();
        const FlowInterval& last = parts[count - 1];
        record.parts.push_back({first.bead, first.s0 / length, last.s1 / length, fit.volume, fit.growth, first.t0,
                                last.t1 - first.t0, false, false});
        parts = parts.subspan(count);
    }
}

}  // namespace

void dividePath(std::span<const FlowInterval> path, std::span<const PathSpot> spots, bool closed, double least,
                FlowRecord& record) {
    std::vector<Cell> cells = averageOver(path, least);
    if (!(cells.front().length > 0)) {
        double volume = cells.front().volume;
        for (const PathSpot& spot : spots) volume += spot.volume;
        record.spots.push_back({path.front().bead, false, closed, volume, path.front().t0});
        return;
    }
    placeSpots(path, spots, closed, cells, record.spots);
    const std::vector<FlowInterval> all = averaged(path, cells);
    const std::size_t first_part = record.parts.size();
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first + 1;
        while (last < all.size() && all[last].bead == all[first].bead) ++last;
        divideBead(std::span(all).subspan(first, last - first), record);
        first = last;
    }
    if (closed || record.parts.size() == first_part) return;
    record.parts[first_part].begins = true;
    record.parts.back().ends = true;
}

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
