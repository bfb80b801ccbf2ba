#include "deposit/flow_path.h"

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

}  // namespace stratum::deposit
