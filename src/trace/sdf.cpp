#include "trace/sdf.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::trace {
namespace {

const Box kEndless{glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};

// Limits of sizes: squares within them neither overflow nor underflow.
constexpr double kMost = 1e60;

void requireSize(double value, const char* what) {
    if (!(value >= 1 / kMost && value <= kMost))
        throw UsageError(
            fmt::format("{} is {}; it must be a number above 0, from {:g} to {:g}", what, value, 1 / kMost, kMost));
}

void requirePlace(const glm::dvec3& p, const char* what) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(p[axis]) <= kMost))
            throw UsageError(fmt::format("{} must be numbers of at most {:g}", what, kMost));
}

void requireParts(const std::vector<SdfPtr>& parts, const char* what) {
    if (parts.empty()) throw UsageError(fmt::format("{} needs at least one shape", what));
}

/// (radial distance from an axis through the origin, position along it).
std::pair<double, double> cylindrical(const glm::dvec3& p, int axis) {
    return {std::hypot(p[(axis + 1) % 3], p[(axis + 2) % 3]), p[axis]};
}

/// A shape by the formula of its distance.
template <typename Distance>
class Formula final : public Sdf {
public:
    Formula(const Box& bounds, Distance distance) : bounds_(bounds), distance_(std::move(distance)) {}
    double distance(const glm::dvec3& p) const override { return distance_(p); }
    Box bounds() const override { return bounds_; }

private:
    Box bounds_;
    Distance distance_;
};

template <typename Distance>
SdfPtr shape(const Box& bounds, Distance distance) {
    return std::make_shared<Formula<Distance>>(bounds, std::move(distance));
}

Box around(const glm::dvec3& center, const glm::dvec3& half) { return {center - half, center + half}; }

/// The first and all others, each unchanged or complemented.
SdfPtr intersection(std::vector<SdfPtr> parts, const Box& bounds, double sign) {
    return shape(bounds, [parts = std::move(parts), sign](const glm::dvec3& p) {
        double d = parts.front()->distance(p);
        for (std::size_t n = 1; n < parts.size(); ++n) d = std::max(d, sign * parts[n]->distance(p));
        return d;
    });
}

}  // namespace

SdfPtr sdfSphere(const glm::dvec3& center, double radius) {
    requirePlace(center, "a sphere's center");
    requireSize(radius, "a sphere's radius");
    return shape(around(center, glm::dvec3(radius)),
                 [=](const glm::dvec3& p) { return glm::length(p - center) - radius; });
}

SdfPtr sdfBox(const glm::dvec3& center, const glm::dvec3& half_extents) {
    requirePlace(center, "a box' center");
    for (int axis = 0; axis < 3; ++axis) requireSize(half_extents[axis], "a box' half extent");
    return shape(around(center, half_extents), [=](const glm::dvec3& p) {
        const glm::dvec3 q = glm::abs(p - center) - half_extents;
        return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    });
}

SdfPtr sdfTorus(const glm::dvec3& center, double radius, double tube, int axis) {
    requirePlace(center, "a torus' center");
    requireSize(radius, "a torus' radius");
    requireSize(tube, "a torus' tube");
    glm::dvec3 half(radius + tube);
    half[axis] = tube;
    return shape(around(center, half), [=](const glm::dvec3& p) {
        const auto [rho, z] = cylindrical(p - center, axis);
        return std::hypot(rho - radius, z) - tube;
    });
}

SdfPtr sdfCylinder(const glm::dvec3& center, double radius, double half_height, int axis) {
    requirePlace(center, "a cylinder's center");
    requireSize(radius, "a cylinder's radius");
    requireSize(half_height, "a cylinder's half height");
    glm::dvec3 half(radius);
    half[axis] = half_height;
    return shape(around(center, half), [=](const glm::dvec3& p) {
        const auto [rho, z] = cylindrical(p - center, axis);
        const double side = rho - radius;
        const double cap = std::abs(z) - half_height;
        return std::hypot(std::max(side, 0.0), std::max(cap, 0.0)) + std::min(std::max(side, cap), 0.0);
    });
}

SdfPtr sdfPlane(const glm::dvec3& normal, double offset) {
    requirePlace(normal, "a plane's normal");
    requireSize(glm::length(normal), "the length of a plane's normal");
    if (!(std::abs(offset) <= kMost))
        throw UsageError(fmt::format("a plane's offset must be a number of at most {:g}", kMost));
    const glm::dvec3 unit = glm::normalize(normal);
    // Along a main axis it is bounded on one side.
    Box box = kEndless;
    for (int axis = 0; axis < 3; ++axis) {
        if (unit[axis] == 1) box.max[axis] = offset;
        if (unit[axis] == -1) box.min[axis] = -offset;
    }
    return shape(box, [=](const glm::dvec3& p) { return glm::dot(unit, p) - offset; });
}

SdfPtr sdfUnion(std::vector<SdfPtr> parts) {
    requireParts(parts, "a union");
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (const SdfPtr& part : parts) {
        const Box own = part->bounds();
        box.min = glm::min(box.min, own.min);
        box.max = glm::max(box.max, own.max);
    }
    return shape(box, [parts = std::move(parts)](const glm::dvec3& p) {
        double d = kInfinity;
        for (const SdfPtr& part : parts) d = std::min(d, part->distance(p));
        return d;
    });
}

SdfPtr sdfIntersection(std::vector<SdfPtr> parts) {
    requireParts(parts, "an intersection");
    Box box = parts.front()->bounds();
    for (const SdfPtr& part : parts) {
        const Box own = part->bounds();
        box.min = glm::max(box.min, own.min);
        box.max = glm::min(box.max, own.max);
    }
    // Disjoint parts have an empty intersection: a point.
    box.max = glm::max(box.min, box.max);
    return intersection(std::move(parts), box, 1.0);
}

SdfPtr sdfSubtraction(std::vector<SdfPtr> parts) {
    requireParts(parts, "a subtraction");
    const Box box = parts.front()->bounds();
    return intersection(std::move(parts), box, -1.0);
}

SdfPtr sdfMoved(SdfPtr part, const glm::dmat3& rotation, const glm::dvec3& offset) {
    requirePlace(offset, "an offset");
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    double off = 0;
    for (int axis = 0; axis < 3; ++axis) off = std::max(off, glm::length(product[axis] - glm::dmat3(1.0)[axis]));
    if (!(off < 1e-9)) throw UsageError("shapes can be turned and moved, not scaled: distances would be wrong");
    const Box own = part->bounds();
    Box box{offset, offset};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            const double m = rotation[column][row];
            if (m == 0) continue;  // 0 times endless is 0 here
            box.min[row] += std::min(m * own.min[column], m * own.max[column]);
            box.max[row] += std::max(m * own.min[column], m * own.max[column]);
        }
    // The inverse of a rotation is its transpose, which is what a row vector multiplies with.
    return shape(box, [=](const glm::dvec3& p) { return part->distance((p - offset) * rotation); });
}

SdfPtr sdfRepetition(SdfPtr part, const glm::dvec3& period, int count) {
    Box box = part->bounds();
    const double most = count < 0 ? kInfinity : count;  // a whole number, or infinite
    for (int axis = 0; axis < 3; ++axis) {
        if (period[axis] == 0) continue;
        requireSize(period[axis], "a period");
        if (!(box.min[axis] >= -0.5 * period[axis] && box.max[axis] <= 0.5 * period[axis]))
            throw UsageError(fmt::format(
                "a shape from {:g} to {:g} along {} can't be repeated every {:g}: it must lie within half a "
                "period of the origin; move or shrink it, or take a longer period",
                box.min[axis], box.max[axis], "xyz"[axis], period[axis]));
        box.min[axis] -= most * period[axis];
        box.max[axis] += most * period[axis];
    }
    return shape(box, [=](const glm::dvec3& p) {
        // The copy in p's cell, and on each axis the neighbour on the nearer side: the nearest copy is among them,
        // because copies stay in their cells.
        double cells[3][2];
        int choices[3];
        for (int axis = 0; axis < 3; ++axis) {
            cells[axis][0] = 0;
            choices[axis] = 1;
            if (!(period[axis] > 0)) continue;
            const double place = p[axis] / period[axis];
            const double nearest = std::clamp(std::round(place), -most, most);
            cells[axis][0] = nearest;
            cells[axis][1] = nearest + (place > nearest ? 1 : -1);
            if (std::abs(cells[axis][1]) <= most) choices[axis] = 2;
        }
        double d = kInfinity;
        for (int x = 0; x < choices[0]; ++x)
            for (int y = 0; y < choices[1]; ++y)
                for (int z = 0; z < choices[2]; ++z)
                    d = std::min(d, part->distance(p - glm::dvec3(cells[0][x], cells[1][y], cells[2][z]) * period));
        return d;
    });
}

}  // namespace stratum::trace
