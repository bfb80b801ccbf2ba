#include "voxelize/beads/part_outline.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

namespace stratum::voxelize {

Bounds partBounds(const gcode::Toolpath& toolpath, std::span<const gcode::Purpose> purposes,
                  std::span<const std::uint32_t> selection, double tilt) {
    const std::vector<std::uint32_t> part = gcode::beadsUpTo(gcode::Purpose::support, purposes, selection);
    Bounds bounds = boundsOf(toolpath, part, tilt);
    std::vector<std::uint32_t> brim;
    std::copy_if(selection.begin(), selection.end(), std::back_inserter(brim),
                 [&](std::uint32_t bead) { return purposes[bead] == gcode::Purpose::brim; });
    // All are taken where nothing but a brim and what is beside the part is selected.
    if (brim.empty() || part.size() == selection.size()) return bounds;
    const Bounds around = boundsOf(toolpath, brim, tilt);
    for (int axis = 0; axis < 2; ++axis) {
        bounds.min[axis] = std::min(bounds.min[axis], std::max(around.min[axis], bounds.min[axis] - kBrimReach));
        bounds.max[axis] = std::max(bounds.max[axis], std::min(around.max[axis], bounds.max[axis] + kBrimReach));
    }
    bounds.min[2] = std::min(bounds.min[2], around.min[2]);
    return bounds;
}

Bounds placed(const Bounds& bounds, const Placement& placement) {
    Bounds world;
    for (int axis = 0; axis < 3; ++axis) {
        world.min[axis] = (bounds.min[axis] + placement.offset[axis]) * placement.unit;
        world.max[axis] = (bounds.max[axis] + placement.offset[axis]) * placement.unit;
    }
    if (!placement.up_y) return world;
    Bounds turned;
    turned.include({{world.min[0], world.min[2], -world.max[1]}, {world.max[0], world.max[2], -world.min[1]}});
    return turned;
}

namespace {

constexpr std::size_t kDirections = 32;
constexpr std::size_t kSlabs = 32;

// How far a slab reaches into each direction, mm from the middle of the part.
using Reach = std::array<float, kDirections>;

class Outline {
public:
    explicit Outline(const Bounds& bounds) : bounds_(bounds) {
        for (std::size_t n = 0; n < kDirections; ++n) {
            const double angle = angleOf(static_cast<double>(n));
            cosine_[n] = static_cast<float>(std::cos(angle));
            sine_[n] = static_cast<float>(std::sin(angle));
        }
        for (Reach& reach : slabs_) reach.fill(-std::numeric_limits<float>::infinity());
    }

    void add(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
        const Section section = sectionOf(toolpath, bead);
        const float half_width = static_cast<float>(section.half_flat + section.radius);
        addPoint(bead.x0, bead.y0, bead.z0, half_width, section);
        addPoint(bead.x1, bead.y1, bead.z1, half_width, section);
        if (bead.arc < 0) return;
        // Pieces that are short enough that the circle stays within a hundredth of its radius of them.
        const gcode::PlanPath path(toolpath, bead);
        constexpr double kStep = 0.25;  // radians
        const int pieces = static_cast<int>(std::abs(path.turn()) / kStep) + 1;
        for (int n = 1; n < pieces; ++n) {
            const double share = static_cast<double>(n) / pieces;
            const gcode::PlanPoint place = path.at(share * path.length());
            addPoint(place.x, place.y, std::lerp(double{bead.z0}, double{bead.z1}, share), half_width, section);
        }
    }

    std::vector<std::array<double, 3>> points() const {
        std::vector<std::array<double, 3>> points;
        for (std::size_t slab = 0; slab < kSlabs; ++slab) {
            const Reach& reach = slabs_[slab];
            if (!std::isfinite(reach[0])) continue;
            for (std::size_t n = 0; n < kDirections; ++n) {
                const std::array<double, 2> corner = cornerOf(reach, n);
                for (const double z : {heightOf(slab), heightOf(slab + 1)}) points.push_back({corner[0], corner[1], z});
            }
        }
        return points;
    }

private:
    static double angleOf(double n) { return 2 * std::numbers::pi * n / kDirections; }
    double middle(std::size_t axis) const { return 0.5 * (bounds_.min[axis] + bounds_.max[axis]); }
    double heightOf(std::size_t slab) const {
        return std::lerp(bounds_.min[2], bounds_.max[2], static_cast<double>(slab) / kSlabs);
    }
    std::size_t slabOf(double z) const {
        const double share = (z - bounds_.min[2]) / std::max(bounds_.max[2] - bounds_.min[2], 1e-9);
        return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0 - 1e-9) * kSlabs);
    }

    void addPoint(double x, double y, double z, float half_width, const Section& section) {
        const auto px = static_cast<float>(x - middle(0));
        const auto py = static_cast<float>(y - middle(1));
        const double middle_z = z - section.drop;
        const std::size_t last = slabOf(middle_z + section.halfHeight());
        for (std::size_t slab = slabOf(middle_z - section.halfHeight()); slab <= last; ++slab)
            for (std::size_t n = 0; n < kDirections; ++n)
                slabs_[slab][n] = std::max(slabs_[slab][n], px * cosine_[n] + py * sine_[n] + half_width);
    }

    // Where the lines of two neighbouring directions meet, within the box.
    std::array<double, 2> cornerOf(const Reach& reach, std::size_t n) const {
        const double a = static_cast<double>(reach[n]);
        const double b = static_cast<double>(reach[(n + 1) % kDirections]);
        const double half = 0.5 * angleOf(1);
        // Along the direction between both, and across.
        const double along = (a + b) / (2 * std::cos(half));
        const double across = (b - a) / (2 * std::sin(half));
        const double angle = angleOf(static_cast<double>(n)) + half;
        return {
            std::clamp(middle(0) + along * std::cos(angle) - across * std::sin(angle), bounds_.min[0], bounds_.max[0]),
            std::clamp(middle(1) + along * std::sin(angle) + across * std::cos(angle), bounds_.min[1], bounds_.max[1])};
    }

    const Bounds bounds_;
    std::array<float, kDirections> cosine_{}, sine_{};
    std::array<Reach, kSlabs> slabs_{};
};

// The points that are farthest in one of the directions, in their old order.
std::vector<std::array<double, 3>> farthest(const std::vector<std::array<double, 3>>& points) {
    std::vector<bool> kept(points.size(), false);
    for (std::size_t n = 0; n < kOutlineDirections; ++n) {
        // Directions that are even over the sphere: heights at even steps, turned by the golden angle.
        const double z = (2 * static_cast<double>(n) + 1) / kOutlineDirections - 1;
        const double flat = std::sqrt(1 - z * z);
        const double angle = static_cast<double>(n) * std::numbers::pi * (3 - std::sqrt(5.0));
        const double x = flat * std::cos(angle);
        const double y = flat * std::sin(angle);
        std::size_t best = 0;
        double reach = -std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double along = points[k][0] * x + points[k][1] * y + points[k][2] * z;
            if (along <= reach) continue;
            reach = along;
            best = k;
        }
        kept[best] = true;
    }
    std::vector<std::array<double, 3>> hull;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (kept[k])
            for (double& coordinate : hull.emplace_back(points[k]))
                coordinate = double{static_cast<float>(coordinate)};  // as in files: the same frame from both
    return hull;
}

}  // namespace

std::vector<std::array<double, 3>> partOutline(const gcode::Toolpath& toolpath,
                                               std::span<const gcode::Purpose> purposes,
                                               std::span<const std::uint32_t> selection, const Bounds& bounds) {
    const auto isPart = [purposes](std::uint32_t bead) { return purposes[bead] != gcode::Purpose::beside; };
    const bool any = std::any_of(selection.begin(), selection.end(), isPart);
    Outline outline(bounds);
    for (const std::uint32_t bead : selection)
        if (!any || isPart(bead)) outline.add(toolpath, toolpath.beads[bead]);
    return farthest(outline.points());
}

std::vector<std::array<double, 3>> placed(std::vector<std::array<double, 3>> outline, const Placement& placement) {
    for (auto& point : outline) {
        point = worldOf(point, placement);
        if (placement.tilt == 0) continue;
        for (double& coordinate : point) coordinate = double{static_cast<float>(coordinate)};
    }
    return outline;
}

std::string textOf(std::span<const std::array<double, 3>> outline) {
    std::string text;
    for (const auto& [x, y, z] : outline)
        fmt::format_to(std::back_inserter(text), "{}{} {} {}", text.empty() ? "" : " ", static_cast<float>(x),
                       static_cast<float>(y), static_cast<float>(z));
    return text;
}

std::vector<std::array<double, 3>> outlineFromText(const std::string& text) {
    std::vector<std::array<double, 3>> points;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at != end) {
        if (points.size() == kOutlineDirections) return {};
        for (double& coordinate : points.emplace_back()) {
            while (at != end && *at == ' ') ++at;
            float number = 0;
            const auto read = fast_float::from_chars(at, end, number);
            if (read.ec != std::errc{} || !std::isfinite(number)) return {};
            coordinate = double{number};
            at = read.ptr;
        }
    }
    return points;
}

}  // namespace stratum::voxelize
