#include "deposit/bead_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::deposit {
namespace {

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

}  // namespace

BeadPath::BeadPath(const gcode::Toolpath& toolpath, const gcode::Bead& bead)
    : x0_(bead.x0), y0_(bead.y0), x1_(bead.x1), y1_(bead.y1) {
    if (bead.arc >= 0) {
        const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
        center_x_ = arc.center_x;
        center_y_ = arc.center_y;
        const double from_x = x0_ - center_x_;
        const double from_y = y0_ - center_y_;
        radius_ = 0.5 * (std::hypot(from_x, from_y) + std::hypot(x1_ - center_x_, y1_ - center_y_));
        sweep_ = arc.sweep;
        angle_ = std::atan2(from_y, from_x);
        length_ = radius_ * std::abs(sweep_);
        if (length_ > 0) return;
        // An arc of no length is a point.
        radius_ = sweep_ = length_ = 0;
        x1_ = x0_;
        y1_ = y0_;
        return;
    }
    const double dx = x1_ - x0_;
    const double dy = y1_ - y0_;
    length_ = std::sqrt(dx * dx + dy * dy);
    if (!(length_ > 0)) return;
    ux_ = dx / length_;
    uy_ = dy / length_;
}

gcode::PlanPoint BeadPath::at(double mm) const {
    if (straight()) return {x0_ + mm * ux_, y0_ + mm * uy_};
    const double angle = angle_ + mm / length_ * sweep_;
    return {center_x_ + radius_ * std::cos(angle), center_y_ + radius_ * std::sin(angle)};
}

double BeadPath::distance(double x, double y) const {
    if (straight()) {
        const double px = x - x0_;
        const double py = y - y0_;
        const double t = std::clamp(px * ux_ + py * uy_, 0.0, length_);
        return std::hypot(px - t * ux_, py - t * uy_);
    }
    const double mm = nearest(x, y);
    if (mm > 0 && mm < length_) return std::abs(std::hypot(x - center_x_, y - center_y_) - radius_);
    const gcode::PlanPoint end = at(mm);
    return std::hypot(x - end.x, y - end.y);
}

double BeadPath::nearest(double x, double y) const {
    if (straight()) return std::clamp((x - x0_) * ux_ + (y - y0_) * uy_, 0.0, length_);
    constexpr double kTurn = 2 * std::numbers::pi;
    const double sweep = std::abs(sweep_);
    double turned = (std::atan2(y - center_y_, x - center_x_) - angle_) * (sweep_ < 0 ? -1 : 1);
    turned -= kTurn * std::floor(turned / kTurn);
    if (turned <= sweep) return std::min(radius_ * turned, length_);
    return turned - sweep < kTurn - turned ? length_ : 0;  // the end that is fewer degrees away
}

std::size_t BeadPath::partsNear(const BeadPath& other, double reach, std::vector<PathPart>& parts) const {
    if (!straight() || !other.straight())
        return walk(
            [&](double mm) {
                const gcode::PlanPoint place = at(mm);
                return other.distance(place.x, place.y) - reach;
            },
            parts);
    if (length_ > 0) {
        segmentNearSegment(other, reach, parts);
    } else if (other.distance(x0_, y0_) <= reach) {
        parts.push_back({0, 0});
    }
    return 1;
}

std::size_t BeadPath::partsBeside(const BeadPath& other, PathPart held, double reach,
                                  std::vector<PathPart>& parts) const {
    if (straight() && other.straight() && length_ > 0) {
        segmentBesideSegment(other, held, reach, parts);
        return 1;
    }
    const std::size_t before = parts.size();
    const std::size_t distances = walk(
        [&](double mm) {
            const gcode::PlanPoint place = at(mm);
            const double gap = other.distance(place.x, place.y) - reach;
            if (gap > 0) return gap;
            return beside(mm, other, held) ? 0 : kFineStep;
        },
        parts);
    // Where two paths meet, the direction between them is rounding.
    const double shortest = std::min(kFineStep, length_);
    const auto first = parts.begin() + static_cast<std::ptrdiff_t>(before);
    parts.erase(
        std::remove_if(first, parts.end(), [&](const PathPart& part) { return part.to - part.from < shortest; }),
        parts.end());
    return distances;
}

// But for the reach.
bool BeadPath::beside(double mm, const BeadPath& other, PathPart held) const {
    const gcode::PlanPoint here = at(mm);
    const double nearest = other.nearest(here.x, here.y);
    if (nearest < held.from || nearest > held.to) return false;
    if (!(length_ > 0)) return true;
    double ux = ux_;
    double uy = uy_;
    if (!straight()) {
        ux = -(here.y - center_y_) / radius_;
        uy = (here.x - center_x_) / radius_;
    }
    const gcode::PlanPoint there = other.at(nearest);
    const double dx = there.x - here.x;
    const double dy = there.y - here.y;
    return std::abs(dx * ux + dy * uy) <= std::abs(dx * uy - dy * ux);
}

// What is within reach of a segment is two discs and the rectangle between them. It is convex, so the line is in it
// from where it first meets one of the three to where it leaves the last.
void BeadPath::segmentNearSegment(const BeadPath& other, double reach, std::vector<PathPart>& parts) const {
    const double ax = other.x0_ - x0_;
    const double ay = other.y0_ - y0_;
    LineRange range = inDisc(ux_, uy_, ax, ay, reach);
    if (other.length_ > 0) {
        range.unite(inDisc(ux_, uy_, other.x1_ - x0_, other.y1_ - y0_, reach));
        LineRange between{-1e300, 1e300};
        between.clip(-(ax * other.ux_ + ay * other.uy_), ux_ * other.ux_ + uy_ * other.uy_, 0, other.length_);
        between.clip(ax * other.uy_ - ay * other.ux_, other.ux_ * uy_ - other.uy_ * ux_, -reach, reach);
        if (between.from <= between.to) range.unite(between);
    }
    const double from = std::max(range.from, 0.0);
    const double to = std::min(range.to, length_);
    if (from <= to) parts.push_back({from, to});
}

// What is nearest to a place in the other's interior lies square to it, so that there the angle between the two decides
// what is beside; what is nearest to an end is in the half plane beyond it.
void BeadPath::segmentBesideSegment(const BeadPath& other, PathPart held, double reach,
                                    std::vector<PathPart>& parts) const {
    const double ax = other.x0_ - x0_;
    const double ay = other.y0_ - y0_;
    const double foot = -(ax * other.ux_ + ay * other.uy_);  // on the other, of this path's start
    const double slope = ux_ * other.ux_ + uy_ * other.uy_;
    const double turn = other.ux_ * uy_ - other.uy_ * ux_;
    const auto keep = [&](LineRange range) {
        range.clip(0, 1, 0, length_);
        if (range.from < range.to) parts.push_back({range.from, range.to});
    };
    if (std::abs(slope) > std::abs(turn)) {
        LineRange range{0, length_};
        range.clip(foot, slope, held.from, held.to);
        range.clip(ax * other.uy_ - ay * other.ux_, turn, -reach, reach);
        keep(range);
    }
    if (held.from <= 0) {
        LineRange range = besideDisc(ux_, uy_, ax, ay, reach);
        range.clip(foot, slope, -1e300, 0);
        keep(range);
    }
    if (held.to >= other.length_) {
        LineRange range = besideDisc(ux_, uy_, other.x1_ - x0_, other.y1_ - y0_, reach);
        range.clip(foot, slope, other.length_, 1e300);
        keep(range);
    }
}

// The parts in which `beyond` is not above 0. A step as long as its absolute value passes nothing over, as the distance
// to another path changes by a mm per mm at most. Returns the number of its values.
template <typename Beyond>
std::size_t BeadPath::walk(const Beyond& beyond, std::vector<PathPart>& parts) const {
    const double least = std::max(kFineStep, length_ / kMostSteps);
    std::size_t values = 1;
    double begin = 0;
    double here = 0;
    double gap = beyond(0);
    while (here < length_) {
        const double next = std::min(length_, here + std::max(least, std::abs(gap)));
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
    if (gap <= 0) parts.push_back({begin, length_});
    return values;
}

}  // namespace stratum::deposit
