#include "study/geometry/exact_solid.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "voxelize/beads/settling.h"
#include "voxelize/swell/swell_field.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace stratum::study {
namespace {

constexpr double kPlanCell = 1;  // mm
constexpr double kFar = 1e9;     // mm
constexpr int kLevelSteps = 2000;

}  // namespace

double ExactSolid::Levels::at(double m) const {
    if (m >= 1) return 1;
    if (m <= closing) return 0;
    const double place = 2 / std::numbers::pi * std::asin(std::sqrt((m - closing) / (1 - closing))) * kLevelSteps;
    const auto node = std::min(static_cast<std::size_t>(place), values.size() - 2);
    return std::lerp(values[node], values[node + 1], place - static_cast<double>(node));
}

ExactSolid::ExactSolid(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double reach)
    : toolpath_(toolpath), stack_(voxelize::stackLayers(toolpath, beads)), reach_(reach) {
    if (beads.empty()) throw UsageError("no level beads: nothing to take points from");
    for (const std::uint32_t bead : stack_.beads) {
        fields_.emplace_back(toolpath, toolpath.beads[bead]);
        bounds_.include(fields_.back().bounds());
    }
    std::map<const voxelize::SettlingCurve*, Levels> known;
    for (const voxelize::Layer& layer : stack_.layers) {
        Levels& levels = known[layer.settling];
        if (layer.settling != nullptr && levels.values.empty()) {
            levels.closing = layer.settling->closing();
            for (int n = 0; n <= kLevelSteps; ++n) {
                const double s = std::sin(0.5 * std::numbers::pi * n / kLevelSteps);
                levels.values.push_back(layer.settling->level(levels.closing + (1 - levels.closing) * s * s));
            }
        }
        levels_.push_back(levels);
    }
    for (int axis = 0; axis < 3; ++axis) {
        bounds_.min[axis] -= reach;
        bounds_.max[axis] += reach;
    }
    listBeads();
}

double ExactSolid::slope() const { return toolpath_.deposit.settles() ? voxelize::kSettledSlope : 1; }

std::size_t ExactSolid::cellOf(double x, double y) const {
    const auto place = [](double v, double low, std::size_t cells) {
        return static_cast<std::size_t>(std::clamp((v - low) / kPlanCell, 0.0, static_cast<double>(cells) - 1));
    };
    return place(y, bounds_.min[1], cells_y_) * cells_x_ + place(x, bounds_.min[0], cells_x_);
}

void ExactSolid::listBeads() {
    cells_x_ = static_cast<std::size_t>(bounds_.extent(0) / kPlanCell) + 1;
    cells_y_ = static_cast<std::size_t>(bounds_.extent(1) / kPlanCell) + 1;
    constexpr double kMostCells = 1e8;
    if (static_cast<double>(cells_x_) * static_cast<double>(cells_y_) * static_cast<double>(stack_.layers.size()) >
        kMostCells)
        throw UsageError("the print's box is too large for exact distances; choose some of its layers");
    cells_.assign(stack_.layers.size() + 1, {});
    for (auto& layer : cells_) layer.resize(cells_x_ * cells_y_);
    for (std::uint32_t rank = 0; rank < stack_.beads.size(); ++rank) {
        const voxelize::BeadField& field = fields_[rank];
        const voxelize::Bounds box = field.bounds();
        // Beads beyond a groove matter as far as two radii from their flats.
        const double more = reach_ + 2 * (field.radius() + field.halfSide());
        const double near = field.halfFlat() + more + field.radius() + std::numbers::sqrt2 / 2 * kPlanCell;
        for (double y = box.min[1] - more;; y += kPlanCell) {
            y = std::min(y, box.max[1] + more);
            for (double x = box.min[0] - more;; x += kPlanCell) {
                x = std::min(x, box.max[0] + more);
                const std::size_t cell = cellOf(x, y);
                const std::size_t row = cell / cells_x_;
                const double middle_x = bounds_.min[0] + (static_cast<double>(cell % cells_x_) + 0.5) * kPlanCell;
                const double middle_y = bounds_.min[1] + (static_cast<double>(row) + 0.5) * kPlanCell;
                std::vector<std::uint32_t>& list = cells_[stack_.layer[rank]][cell];
                if ((list.empty() || list.back() != rank) && field.path().distance(middle_x, middle_y) <= near)
                    list.push_back(rank);
                if (x >= box.max[0] + more) break;
            }
            if (y >= box.max[1] + more) break;
        }
    }
}

ExactSolid::Near ExactSolid::nearTo(std::uint32_t rank, double x, double y) const {
    const voxelize::BeadField& field = fields_[rank];
    const gcode::Bead& bead = toolpath_.beads[stack_.beads[rank]];
    double dx = 0;
    double dy = 0;
    if (bead.arc < 0) {
        const double t = field.path().parameter(x, y);
        dx = x - std::lerp(double{bead.x0}, double{bead.x1}, t);
        dy = y - std::lerp(double{bead.y0}, double{bead.y1}, t);
    } else {
        constexpr double kStep = 1e-6;  // mm
        dx = field.path().distance(x + kStep, y) - field.path().distance(x - kStep, y);
        dy = field.path().distance(x, y + kStep) - field.path().distance(x, y - kStep);
    }
    const double length = std::hypot(dx, dy);
    return {field.planOffset(x, y), length > 0 ? dx / length : 0, length > 0 ? dy / length : 0};
}

// The plan distance of a layer, and the same closed where a groove is within what welds close.
ExactSolid::Plan ExactSolid::filled(std::size_t number, double x, double y) const {
    const voxelize::Layer& layer = stack_.layers[number];
    const double radius = layer.radius;
    double d = kFar;
    std::vector<Near> beads;
    for (const std::uint32_t rank : cells_[number][cellOf(x, y)]) {
        const Near bead = nearTo(rank, x, y);
        d = std::min(d, bead.d);
        if (bead.d < 2 * radius) beads.push_back(bead);
    }
    Plan plan{d, d, 0};
    if (layer.settling == nullptr || d >= radius || !(radius > 0)) return plan;
    const double weld = layer.settling->weldLevel();
    for (std::size_t a = 0; a < beads.size(); ++a)
        for (std::size_t b = a + 1; b < beads.size(); ++b) {
            const double gap = std::max(beads[a].d, 0.0) + std::max(beads[b].d, 0.0);
            if (gap >= 2 * radius) continue;
            const double cosine = beads[a].nx * beads[b].nx + beads[a].ny * beads[b].ny;
            const double off = std::max((cosine - voxelize::kOpposite) / -voxelize::kOpposite, 0.0);
            const double m = 0.5 * (gap / radius + voxelize::kTurnPenalty * off * off);
            if (m >= 1) continue;
            const double level = levels_[number].at(m);
            plan.settled = std::min(plan.settled, level * radius);
            plan.closed = std::min(plan.closed, (level - weld * (1 - level)) * radius);
        }
    return plan;
}

// The same with its outlines moved out, and its top up, by what has no place in the grooves.
ExactSolid::Plan ExactSolid::plan(std::size_t number, double x, double y) const {
    Plan plan = filled(number, x, y);
    if (stack_.swell == nullptr) return plan;
    const voxelize::Swell swell = stack_.swell->at(toolpath_, stack_, static_cast<std::uint32_t>(number), x, y);
    plan.settled -= swell.out;
    plan.closed -= swell.out;
    plan.rise = swell.rise;
    const voxelize::Layer& layer = stack_.layers[number];
    if (layer.crown > 0) {
        double nearest = kFar;
        for (const std::uint32_t rank : cells_[number][cellOf(x, y)]) nearest = std::min(nearest, nearTo(rank, x, y).d);
        plan.rise -= swell.open * voxelize::crownDepth(layer.crown, layer.radius, nearest);
    }
    return plan;
}

// What touching layers share: nothing outside, and no crack inside (voxelize::Weld).
double ExactSolid::welded(const glm::dvec3& p, std::span<const std::pair<std::uint32_t, double>> closed) const {
    double least = kFar;
    const auto closedOf = [&](std::uint32_t layer) {
        for (const auto& [number, value] : closed)
            if (number == layer) return value;
        return kFar;
    };
    for (const voxelize::Weld& pair : stack_.welds) {
        const double lower = stack_.layers[pair.lower].center_z;
        const double upper = stack_.layers[pair.upper].center_z;
        if (p.z < lower || p.z > upper) continue;
        const double bound = std::max({closedOf(pair.lower), closedOf(pair.upper),
                                       std::abs(p.z - 0.5 * (lower + upper)) - 0.5 * (upper - lower)});
        if (bound < 0) least = std::min(least, bound);
    }
    return least;
}

double ExactSolid::distance(const glm::dvec3& p) const {
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] < bounds_.min[axis] || p[axis] > bounds_.max[axis]) return reach_;
    double least = reach_;
    std::vector<std::pair<std::uint32_t, double>> closed;
    for (std::uint32_t number = 0; number < stack_.layers.size(); ++number) {
        const voxelize::Layer& layer = stack_.layers[number];
        const double height = p.z - layer.center_z;
        if (height <= -layer.halfHeight() - reach_ || height >= layer.halfHeight() + layer.most_rise + reach_) continue;
        const Plan plan = this->plan(number, p.x, p.y);
        // The upper half is moved up; down by half at most.
        const double before = std::max(std::min(height - plan.rise, 2 * height), std::min(height, 0.0));
        const double over = std::abs(before) - layer.half_side;
        closed.emplace_back(number, plan.closed);
        const double inside = layer.half_side > 0 ? std::min(std::max(plan.settled, over), 0.0) : 0.0;
        least = std::min(least, std::hypot(std::max(plan.settled, 0.0), std::max(over, 0.0)) + inside - layer.radius);
    }
    for (const std::uint32_t rank : cells_.back()[cellOf(p.x, p.y)])
        least = std::min(least, fields_[rank].distance(p.x, p.y, p.z));
    return std::min(least, welded(p, closed));
}

// By bisection between a point inside and one outside.
ExactSolid::SurfacePoint ExactSolid::pointBetween(const glm::dvec3& a, const glm::dvec3& b, bool a_inside) const {
    double low = 0;
    double high = 1;
    for (int n = 0; n < 40; ++n) {
        const double middle = 0.5 * (low + high);
        ((distance(glm::mix(a, b, middle)) < 0) == a_inside ? low : high) = middle;
    }
    SurfacePoint point;
    point.position = glm::mix(a, b, a_inside ? high : low);
    constexpr double kStep = 1e-5;  // mm
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0);
        step[axis] = kStep;
        point.normal[axis] = distance(point.position + step) - distance(point.position - step);
    }
    const double length = glm::length(point.normal);
    point.normal = length > 0 ? point.normal / length : glm::dvec3(0, 0, 1);
    return point;
}

void ExactSolid::crossings(std::uint64_t seed, std::vector<SurfacePoint>& found) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::normal_distribution<double> normal;
    const glm::dvec3 low(bounds_.min[0], bounds_.min[1], bounds_.min[2]);
    const glm::dvec3 high(bounds_.max[0], bounds_.max[1], bounds_.max[2]);
    const double radius = 0.5 * glm::length(high - low);
    const glm::dvec3 along = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 aside =
        glm::normalize(glm::cross(along, std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    double u = 1;
    double v = 1;
    while (u * u + v * v > 1) {
        u = unit(random);
        v = unit(random);
    }
    const glm::dvec3 origin = 0.5 * (low + high) + radius * (u * aside + v * glm::cross(along, aside));
    double from = -radius;
    double to = radius;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (low[axis] - origin[axis]) / along[axis];
        const double b = (high[axis] - origin[axis]) / along[axis];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    if (from >= to) return;
    glm::dvec3 last = origin + from * along;
    double value = distance(last);
    double t = from;
    while (t < to) {
        t += std::max(std::abs(value) / slope(), kLineStep);
        const glm::dvec3 next = origin + t * along;
        const double there = distance(next);
        if ((there < 0) != (value < 0)) found.push_back(pointBetween(last, next, value < 0));
        last = next;
        value = there;
    }
}

std::vector<ExactSolid::SurfacePoint> ExactSolid::samplePoints(std::size_t count, std::uint32_t seed) const {
    constexpr std::size_t kLinesAtOnce = 512;
    constexpr std::size_t kMostLines = 10'000'000;
    std::vector<SurfacePoint> points;
    for (std::size_t first = 0; points.size() < count; first += kLinesAtOnce) {
        if (first > kMostLines) throw InputError("hardly any line meets the beads; nothing to take points from");
        std::vector<std::vector<SurfacePoint>> found(kLinesAtOnce);
        parallelFor(kLinesAtOnce, 8, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n != end; ++n)
                crossings(static_cast<std::uint64_t>(seed) << 40 | (first + n), found[n]);
        });
        for (const auto& line : found) points.insert(points.end(), line.begin(), line.end());
    }
    points.resize(count);
    return points;
}

double ExactSolid::clearance(const SurfacePoint& point, double limit) const {
    // Away from the point's own bead distances grow as fast as the way; what makes them shrink again is another wall.
    constexpr double kLeave = 1e-5;  // mm: well above rounding, well below anything printed
    double t = kLeave;
    while (t < limit) {
        const double free = distance(point.position + t * point.normal);
        if (free <= 0.1 * kLeave) return t;
        t += free / slope();
    }
    return limit;
}

ExactSolid::Volume ExactSolid::volume(std::size_t points_of_each, const std::function<Inside()>& other,
                                      int shifts) const {
    // Powers of the root of x^4 = x + 1: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
    constexpr double kRoot = 1.22074408460575947536;
    const glm::dvec3 step(1 / kRoot, 1 / (kRoot * kRoot), 1 / (kRoot * kRoot * kRoot));
    const voxelize::Bounds& box = bounds();
    const glm::dvec3 low(box.min[0], box.min[1], box.min[2]);
    const glm::dvec3 size(box.extent(0), box.extent(1), box.extent(2));
    const double each = size.x * size.y * size.z / static_cast<double>(points_of_each);
    std::vector<double> volumes;
    std::vector<double> excesses;
    for (int shift = 0; shift < shifts; ++shift) {
        std::mt19937_64 random(static_cast<std::uint64_t>(shift) + 77);
        std::uniform_real_distribution<double> unit(0, 1);
        const glm::dvec3 start(unit(random), unit(random), unit(random));
        std::atomic<std::int64_t> inside{0};
        std::atomic<std::int64_t> more{0};
        parallelFor(points_of_each, 4096, [&](std::size_t first, std::size_t last) {
            const Inside inside_other = other ? other() : Inside();
            std::int64_t here = 0;
            std::int64_t there = 0;
            for (std::size_t n = first; n != last; ++n) {
                const glm::dvec3 p = low + size * glm::fract(start + step * static_cast<double>(n));
                const int own = distance(p) < 0 ? 1 : 0;
                here += own;
                if (inside_other) there += (inside_other(p) ? 1 : 0) - own;
            }
            inside += here;
            more += there;
        });
        volumes.push_back(each * static_cast<double>(inside));
        excesses.push_back(each * static_cast<double>(more));
    }
    const auto mean = [shifts](const std::vector<double>& values, double& error) {
        double sum = 0;
        for (const double v : values) sum += v / shifts;
        double squares = 0;
        for (const double v : values) squares += (v - sum) * (v - sum);
        error = std::sqrt(squares / (shifts - 1) / shifts);
        return sum;
    };
    Volume result;
    result.value = mean(volumes, result.error);
    result.excess = mean(excesses, result.excess_error);
    return result;
}

}  // namespace stratum::study
