#include "deposit/path_parts.h"

#include <algorithm>
#include <cmath>

namespace stratum::deposit {
namespace {

using gcode::PlanPath;
using gcode::PlanPoint;

constexpr double kBisectedTo = 1e-6;  // mm
constexpr double kMostSteps = 4096;   // along one path, so that an absurdly long arc ends

// The parameters t of a line p + t u for which it lies in a convex region; empty while from > to.
struct LineRange {
    double from = 1e300;
    double to = -1e300;

    void unite(const LineRange& other) {
        from = std::min(from, other.from);
        to = std::max(to, other.to);
    }
    // Keeps t with low <= value + t * slope <= high.
    void clip(double value, double slope, double low, double high) {
        if (slope == 0) {
            if (value < low || value > high) *this = {};
            return;
        }
        const double a = (low - value) / slope;
        const double b = (high - value) / slope;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
};

// In a disc about a point that lies (x, y) from the line's origin.
LineRange inDisc(double ux, double uy, double x, double y, double radius) {
    const double along = x * ux + y * uy;
    const double across = x * uy - y * ux;
    const double half2 = radius * radius - across * across;
    if (!(half2 >= 0)) return {};
    const double half = std::sqrt(half2);
    return {along - half, along + half};
}

// Of the same disc, where the point lies more across the line than along it.
LineRange besideDisc(double ux, double uy, double x, double y, double radius) {
    LineRange range = inDisc(ux, uy, x, y, radius);
    range.clip(-(x * ux + y * uy), 1, -std::abs(x * uy - y * ux), std::abs(x * uy - y * ux));
    return range;
}

// But for the reach.
bool beside(const PlanPath& path, double mm, const PlanPath& other, PathPart held) {
    const PlanPoint here = path.at(mm);
    const double nearest = other.nearest(here.x, here.y);
    if (nearest < held.from || nearest > held.to) return false;
    if (!(path.length() > 0)) return true;
    const PlanPoint u = path.direction(mm);
    const PlanPoint there = other.at(nearest);
    const double dx = there.x - here.x;
    const double dy = there.y - here.y;
    return std::abs(dx * u.x + dy * u.y) <= std::abs(dx * u.y - dy * u.x);
}

// What is within reach of a segment is two discs and the rectangle between them. It is convex, so the line is in it
// from where it first meets one of the three to where it leaves the last.
void segmentNearSegment(const PlanPath& path, const PlanPath& other, double reach, std::vector<PathPart>& parts) {
    const PlanPoint start = path.at(0);
    const PlanPoint u = path.direction(0);
    const PlanPoint other_start = other.at(0);
    const PlanPoint v = other.direction(0);
    const double ax = other_start.x - start.x;
    const double ay = other_start.y - start.y;
    LineRange range = inDisc(u.x, u.y, ax, ay, reach);
    if (other.length() > 0) {
        const PlanPoint other_end = other.at(other.length());
        range.unite(inDisc(u.x, u.y, other_end.x - start.x, other_end.y - start.y, reach));
        LineRange between{-1e300, 1e300};
        between.clip(-(ax * v.x + ay * v.y), u.x * v.x + u.y * v.y, 0, other.length());
        between.clip(ax * v.y - ay * v.x, v.x * u.y - v.y * u.x, -reach, reach);
        if (between.from <= between.to) range.unite(between);
    }
    const double from = std::max(range.from, 0.0);
    const double to = std::min(range.to, path.length());
    if (from <= to) parts.push_back({from, to});
}

// What is nearest to a place in the other's interior lies square to it, so that there the angle between the two decides
// what is beside; what is nearest to an end is in the half plane beyond it.
void segmentBesideSegment(const PlanPath& path, const PlanPath& other, PathPart held, double reach,
                          std::vector<PathPart>& parts) {
    const PlanPoint start = path.at(0);
    const PlanPoint u = path.direction(0);
    const PlanPoint other_start = other.at(0);
    const PlanPoint other_end = other.at(other.length());
    const PlanPoint v = other.direction(0);
    const double ax = other_start.x - start.x;
    const double ay = other_start.y - start.y;
    const double foot = -(ax * v.x + ay * v.y);  // on the other, of this path's start
    const double slope = u.x * v.x + u.y * v.y;
    const double turn = v.x * u.y - v.y * u.x;
    const auto keep = [&](LineRange range) {
        range.clip(0, 1, 0, path.length());
        if (range.from < range.to) parts.push_back({range.from, range.to});
    };
    if (std::abs(slope) > std::abs(turn)) {
        LineRange range{0, path.length()};
        range.clip(foot, slope, held.from, held.to);
        range.clip(ax * v.y - ay * v.x, turn, -reach, reach);
        keep(range);
    }
    if (held.from <= 0) {
        LineRange range = besideDisc(u.x, u.y, ax, ay, reach);
        range.clip(foot, slope, -1e300, 0);
        keep(range);
    }
    if (held.to >= other.length()) {
        LineRange range = besideDisc(u.x, u.y, other_end.x - start.x, other_end.y - start.y, reach);
        range.clip(foot, slope, other.length(), 1e300);
        keep(range);
    }
}

// The parts in which `beyond` is not above 0. A step as long as its absolute value passes nothing over, as the distance
// to another path changes by a mm per mm at most. Returns the number of its values.
template <typename Beyond>
std::size_t walk(const PlanPath& path, const Beyond& beyond, std::vector<PathPart>& parts) {
    const double length = path.length();
    const double least = std::max(kFineStep, length / kMostSteps);
    std::size_t values = 1;
    double begin = 0;
    double here = 0;
    double gap = beyond(0);
    while (here < length) {
        const double next = std::min(length, here + std::max(least, std::abs(gap)));
        const double next_gap = beyond(next);
        ++values;
        if ((gap <= 0) != (next_gap <= 0)) {
            double low = here;
            double high = next;
            while (high - low > kBisectedTo) {
                const double middle = 0.5 * (low + high);
                if (middle <= low || middle >= high) break;  // no double lies between them
                ((beyond(middle) <= 0) == (gap <= 0) ? low : high) = middle;
                ++values;
            }
            if (gap <= 0)
                parts.push_back({begin, low});
            else
                begin = high;
        }
        here = next;
        gap = next_gap;
    }
    if (gap <= 0) parts.push_back({begin, length});
    return values;
}

}  // namespace

std::size_t partsNear(const PlanPath& path, const PlanPath& other, double reach, std::vector<PathPart>& parts) {
    if (!path.straight() || !other.straight())
        return walk(
            path,
            [&](double mm) {
                const PlanPoint place = path.at(mm);
                return other.distance(place.x, place.y) - reach;
            },
            parts);
    if (path.length() > 0) {
        segmentNearSegment(path, other, reach, parts);
    } else if (other.distance(path.at(0).x, path.at(0).y) <= reach) {
        parts.push_back({0, 0});
    }
    return 1;
}

std::size_t partsBeside(const PlanPath& path, const PlanPath& other, PathPart held, double reach,
                        std::vector<PathPart>& parts) {
    if (path.straight() && other.straight() && path.length() > 0) {
        segmentBesideSegment(path, other, held, reach, parts);
        return 1;
    }
    const std::size_t before = parts.size();
    const std::size_t distances = walk(
        path,
        [&](double mm) {
            const PlanPoint place = path.at(mm);
            const double gap = other.distance(place.x, place.y) - reach;
            if (gap > 0) return gap;
            return beside(path, mm, other, held) ? 0 : kFineStep;
        },
        parts);
    // Where two paths meet, the direction between them is rounding.
    const double shortest = std::min(kFineStep, path.length());
    const auto first = parts.begin() + static_cast<std::ptrdiff_t>(before);
    parts.erase(
        std::remove_if(first, parts.end(), [&](const PathPart& part) { return part.to - part.from < shortest; }),
        parts.end());
    return distances;
}

}  // namespace stratum::deposit
