#include "study/geometry/union_field.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "voxelize/beads/layer_stack.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <random>

namespace stratum::study {
namespace {

constexpr double kCell = 1;         // mm
constexpr double kTouching = 1e-9;  // mm: a thousand roundings of a coordinate of a metre

// Area of a straight bead's sides, and of its two ends, which together are a disc with half a torus around it.
double sideArea(double length, double flat, double radius) {
    return length * (4 * flat + 2 * std::numbers::pi * radius);
}
double endArea(double flat, double radius) {
    return 2 * std::numbers::pi * flat * flat + 2 * std::numbers::pi * std::numbers::pi * flat * radius +
           4 * std::numbers::pi * radius * radius;
}

}  // namespace

UnionField::UnionField(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double reach)
    : reach_(reach) {
    double sum = 0;
    for (const std::uint32_t index : beads) {
        const gcode::Bead& bead = toolpath.beads[index];
        Solid solid{voxelize::BeadField(toolpath, bead), voxelize::sectionOf(toolpath, bead)};
        const double drop = solid.section.drop;
        solid.start = {bead.x0, bead.y0, bead.z0 - drop};
        solid.end = {bead.x1, bead.y1, bead.z1 - drop};
        solid.length = solid.field.path().length();
        solid.height = static_cast<double>(toolpath.runOf(bead).height);
        if (bead.arc >= 0) {
            const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
            solid.arc_center = {arc.center_x, arc.center_y, solid.start.z};
            const glm::dvec3 from = solid.start - solid.arc_center;
            const glm::dvec3 to = solid.end - solid.arc_center;
            // As gcode::Arc says: the mean, so that a file's rounding is shared by both ends.
            solid.arc_radius = 0.5 * (std::hypot(from.x, from.y) + std::hypot(to.x, to.y));
            solid.arc_from = std::atan2(from.y, from.x);
            solid.arc_sweep = arc.sweep;
        }
        bounds_.include(solid.field.bounds());
        if (solid.field.level()) {
            const double flat = solid.section.half_flat;
            const double radius = solid.section.radius;
            // The outer side of an arc is longer than its path; what is too much there is turned down on the inner one.
            const double stretch = solid.arc_radius > 0 ? 1 + (flat + radius) / solid.arc_radius : 1;
            sum += sideArea(solid.length * stretch, flat, radius) + endArea(flat, radius);
        }
        area_.push_back(sum);
        solids_.push_back(solid);
    }
    listBeads();
}

void UnionField::listBeads() {
    for (int axis = 0; axis < 3; ++axis) {
        bounds_.min[axis] -= reach_;
        bounds_.max[axis] += reach_;
        cells_[axis] = static_cast<int>(bounds_.extent(axis) / kCell) + 1;
    }
    constexpr double kMostCells = 1e8;
    if (static_cast<double>(cells_.x) * cells_.y * cells_.z > kMostCells)
        throw UsageError("the print's box is too large for exact distances; choose some of its layers");
    const auto count =
        static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y) * static_cast<std::size_t>(cells_.z);
    first_.assign(count + 1, 0);
    // Twice: to count, and to write.
    const auto visit = [&](const auto& body) {
        for (std::size_t n = 0; n < solids_.size(); ++n) {
            const voxelize::BeadField& field = solids_[n].field;
            const voxelize::Bounds box = field.bounds();
            const glm::ivec3 low = cellOf(glm::dvec3(box.min[0], box.min[1], box.min[2]) - reach_);
            const glm::ivec3 high = cellOf(glm::dvec3(box.max[0], box.max[1], box.max[2]) + reach_);
            const double near = field.halfFlat() + field.radius() + reach_ + std::sqrt(0.5) * kCell;
            for (int x = low.x; x <= high.x; ++x)
                for (int y = low.y; y <= high.y; ++y) {
                    if (field.path().distance(bounds_.min[0] + (x + 0.5) * kCell, bounds_.min[1] + (y + 0.5) * kCell) >
                        near)
                        continue;
                    for (int z = low.z; z <= high.z; ++z) body(indexOf({x, y, z}), static_cast<std::uint32_t>(n));
                }
        }
    };
    visit([&](std::size_t cell, std::uint32_t) { ++first_[cell + 1]; });
    for (std::size_t cell = 0; cell < count; ++cell) first_[cell + 1] += first_[cell];
    listed_.resize(first_[count]);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    visit([&](std::size_t cell, std::uint32_t n) { listed_[next[cell]++] = n; });
}

glm::ivec3 UnionField::cellOf(const glm::dvec3& p) const {
    glm::ivec3 cell;
    for (int axis = 0; axis < 3; ++axis)
        cell[axis] = std::clamp(static_cast<int>((p[axis] - bounds_.min[axis]) / kCell), 0, cells_[axis] - 1);
    return cell;
}

std::size_t UnionField::indexOf(const glm::ivec3& cell) const {
    return (static_cast<std::size_t>(cell.x) * static_cast<std::size_t>(cells_.y) + static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(cells_.z) +
           static_cast<std::size_t>(cell.z);
}

std::span<const std::uint32_t> UnionField::near(const glm::dvec3& p) const {
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] < bounds_.min[axis] || p[axis] > bounds_.max[axis]) return {};
    const std::size_t cell = indexOf(cellOf(p));
    return std::span(listed_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
}

double UnionField::distance(const glm::dvec3& p) const {
    double least = reach_;
    for (const std::uint32_t n : near(p)) {
        const Solid& solid = solids_[n];
        // A bead is no nearer than its slab: most of those listed lie above or below.
        if (solid.field.level() && std::abs(p.z - solid.start.z) - solid.section.radius >= std::max(least, 0.0))
            continue;
        least = std::min(least, solid.field.distance(p.x, p.y, p.z));
    }
    return least;
}

// Whether a flat that faces this one covers the point (then it is welded), or one of the same plane does that was
// printed before (then the point is that one's).
bool UnionField::onOthersFlat(std::size_t own, const glm::dvec3& p, bool top) const {
    for (const std::uint32_t n : near(p)) {
        const Solid& other = solids_[n];
        if (n == own || !other.field.level()) continue;
        const double side = top ? other.section.radius : -other.section.radius;
        const double gap = voxelize::kWeldGap * std::min(other.height, solids_[own].height);
        const bool faces = std::abs(other.start.z - side - p.z) <= gap;
        const bool same = n < own && std::abs(other.start.z + side - p.z) <= kTouching;
        if ((faces || same) && other.field.path().distance(p.x, p.y) <= other.section.half_flat) return true;
    }
    return false;
}

template <typename Random>
bool UnionField::tryPoint(Random& random, SurfacePoint& point) const {
    std::uniform_real_distribution<double> unit(0, 1);
    const double drawn = unit(random) * area_.back();
    const auto own =
        std::min(static_cast<std::size_t>(std::upper_bound(area_.begin(), area_.end(), drawn) - area_.begin()),
                 area_.size() - 1);
    const Solid& solid = solids_[own];
    const double flat = solid.section.half_flat;
    const double radius = solid.section.radius;
    const bool arc = solid.arc_radius > 0;
    const double stretch = arc ? 1 + (flat + radius) / solid.arc_radius : 1;
    const double sides = sideArea(solid.length * stretch, flat, radius);
    // Around the section: where, which way it faces; `out` counts from the path.
    double out = 0;
    double up = 0;
    double facing_out = 0;
    bool on_flat = false;
    glm::dvec2 base(0);
    glm::dvec2 outwards(0);
    if (unit(random) * (sides + endArea(flat, radius)) < sides) {
        const double along = unit(random);
        double around = unit(random) * (4 * flat + 2 * std::numbers::pi * radius);
        on_flat = around < 4 * flat;
        if (on_flat) {
            out = std::fmod(around, 2 * flat) - flat;
            up = around < 2 * flat ? 1 : -1;
        } else {
            around = (around - 4 * flat) / radius;  // 0 .. 2 pi; 0 is straight up
            up = std::cos(around);
            facing_out = std::sin(around);
            out = std::copysign(flat, facing_out) + radius * facing_out;
        }
        if (arc) {
            // To the right of a turn to the left is outwards; the distance from the centre is what counts.
            const double angle = solid.arc_from + along * solid.arc_sweep;
            const double reach = 1 + out / solid.arc_radius;
            if (unit(random) * stretch > reach) return false;
            outwards = {std::cos(angle), std::sin(angle)};
            base = glm::dvec2(solid.arc_center) + solid.arc_radius * outwards;
        } else {
            const glm::dvec2 direction = glm::dvec2(solid.end - solid.start) / std::max(solid.length, 1e-300);
            outwards = {direction.y, -direction.x};
            base = glm::mix(glm::dvec2(solid.start), glm::dvec2(solid.end), along);
        }
    } else {
        const double turn = 2 * std::numbers::pi * unit(random);
        outwards = {std::cos(turn), std::sin(turn)};
        on_flat = unit(random) * endArea(flat, radius) < 2 * std::numbers::pi * flat * flat;
        if (on_flat) {
            out = flat * std::sqrt(unit(random));
            up = unit(random) < 0.5 ? 1 : -1;
        } else {
            const double angle = std::numbers::pi * (unit(random) - 0.5);
            up = std::sin(angle);
            facing_out = std::cos(angle);
            out = flat + radius * facing_out;
            if (unit(random) * (flat + radius) > out) return false;
        }
        // Each half of the circle belongs to the end that it looks away from.
        glm::dvec2 ahead = glm::dvec2(solid.end - solid.start);
        glm::dvec2 behind = -ahead;
        if (arc) {
            const double sense = solid.arc_sweep > 0 ? 1 : -1;
            const double last = solid.arc_from + solid.arc_sweep;
            ahead = sense * glm::dvec2(-std::sin(last), std::cos(last));
            behind = -sense * glm::dvec2(-std::sin(solid.arc_from), std::cos(solid.arc_from));
        }
        if (glm::dot(outwards, ahead) >= 0)
            base = glm::dvec2(solid.end);
        else if (glm::dot(outwards, behind) > 0)
            base = glm::dvec2(solid.start);
        else
            return false;
    }
    point.position = {base + out * outwards, solid.start.z + radius * up};
    point.normal = glm::normalize(glm::dvec3(facing_out * outwards, up));
    if (distance(point.position) < -kTouching) return false;
    return !(on_flat && onOthersFlat(own, point.position, up > 0));
}

std::vector<UnionField::SurfacePoint> UnionField::samplePoints(std::size_t count, std::uint32_t seed) const {
    if (area_.empty() || !(area_.back() > 0)) throw UsageError("no level beads: nothing to take points from");
    std::vector<SurfacePoint> points(count);
    std::atomic<bool> failed{false};
    parallelFor(count, 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            std::mt19937_64 random(static_cast<std::uint64_t>(seed) << 32 | n);
            int tries = 0;
            constexpr int kMostTries = 100000;
            while (tries < kMostTries && !tryPoint(random, points[n])) ++tries;
            if (tries == kMostTries) failed = true;
        }
    });
    if (failed) throw InputError("hardly any of the beads' surface is the union's; nothing to take points from");
    return points;
}

}  // namespace stratum::study
