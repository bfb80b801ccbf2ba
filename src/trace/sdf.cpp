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

class Sphere final : public Sdf {
public:
    Sphere(const glm::dvec3& center, double radius) : center_(center), radius_(radius) {}
    double distance(const glm::dvec3& p) const override { return glm::length(p - center_) - radius_; }
    Box bounds() const override { return {center_ - radius_, center_ + radius_}; }

private:
    glm::dvec3 center_;
    double radius_;
};

class BoxShape final : public Sdf {
public:
    BoxShape(const glm::dvec3& center, const glm::dvec3& half) : center_(center), half_(half) {}
    double distance(const glm::dvec3& p) const override {
        const glm::dvec3 q = glm::abs(p - center_) - half_;
        return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    }
    Box bounds() const override { return {center_ - half_, center_ + half_}; }

private:
    glm::dvec3 center_, half_;
};

class Torus final : public Sdf {
public:
    Torus(const glm::dvec3& center, double radius, double tube, int axis)
        : center_(center), radius_(radius), tube_(tube), axis_(axis) {}
    double distance(const glm::dvec3& p) const override {
        const auto [rho, z] = cylindrical(p - center_, axis_);
        return std::hypot(rho - radius_, z) - tube_;
    }
    Box bounds() const override {
        glm::dvec3 half(radius_ + tube_);
        half[axis_] = tube_;
        return {center_ - half, center_ + half};
    }

private:
    glm::dvec3 center_;
    double radius_, tube_;
    int axis_;
};

class Cylinder final : public Sdf {
public:
    Cylinder(const glm::dvec3& center, double radius, double half, int axis)
        : center_(center), radius_(radius), half_(half), axis_(axis) {}
    double distance(const glm::dvec3& p) const override {
        const auto [rho, z] = cylindrical(p - center_, axis_);
        const double side = rho - radius_;
        const double cap = std::abs(z) - half_;
        return std::hypot(std::max(side, 0.0), std::max(cap, 0.0)) + std::min(std::max(side, cap), 0.0);
    }
    Box bounds() const override {
        glm::dvec3 half(radius_);
        half[axis_] = half_;
        return {center_ - half, center_ + half};
    }

private:
    glm::dvec3 center_;
    double radius_, half_;
    int axis_;
};

class Plane final : public Sdf {
public:
    Plane(const glm::dvec3& normal, double offset) : normal_(normal), offset_(offset) {}
    double distance(const glm::dvec3& p) const override { return glm::dot(normal_, p) - offset_; }
    Box bounds() const override {
        // Along a main axis it is bounded on one side.
        Box box = kEndless;
        for (int axis = 0; axis < 3; ++axis) {
            if (normal_[axis] == 1) box.max[axis] = offset_;
            if (normal_[axis] == -1) box.min[axis] = -offset_;
        }
        return box;
    }

private:
    glm::dvec3 normal_;
    double offset_;
};

class Union final : public Sdf {
public:
    explicit Union(std::vector<SdfPtr> parts) : parts_(std::move(parts)) {}
    double distance(const glm::dvec3& p) const override {
        double d = kInfinity;
        for (const SdfPtr& part : parts_) d = std::min(d, part->distance(p));
        return d;
    }
    Box bounds() const override {
        Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
        for (const SdfPtr& part : parts_) {
            const Box own = part->bounds();
            box.min = glm::min(box.min, own.min);
            box.max = glm::max(box.max, own.max);
        }
        return box;
    }

private:
    std::vector<SdfPtr> parts_;
};

/// Intersection of the first with all others, each unchanged or complemented.
class Intersection final : public Sdf {
public:
    Intersection(std::vector<SdfPtr> parts, bool subtract) : parts_(std::move(parts)), sign_(subtract ? -1.0 : 1.0) {}
    double distance(const glm::dvec3& p) const override {
        double d = parts_.front()->distance(p);
        for (std::size_t n = 1; n < parts_.size(); ++n) d = std::max(d, sign_ * parts_[n]->distance(p));
        return d;
    }
    Box bounds() const override {
        Box box = parts_.front()->bounds();
        if (sign_ < 0) return box;
        // Each part once: nested intersections would double the work at each level.
        for (std::size_t n = 1; n < parts_.size(); ++n) {
            const Box own = parts_[n]->bounds();
            box.min = glm::max(box.min, own.min);
            box.max = glm::min(box.max, own.max);
        }
        // Disjoint parts have an empty intersection: a point.
        box.max = glm::max(box.min, box.max);
        return box;
    }

private:
    std::vector<SdfPtr> parts_;
    double sign_;
};

class Moved final : public Sdf {
public:
    Moved(SdfPtr part, const glm::dmat3& rotation, const glm::dvec3& offset)
        : part_(std::move(part)), rotation_(rotation), offset_(offset) {}
    // The inverse of a rotation is its transpose, which is what a row vector multiplies with.
    double distance(const glm::dvec3& p) const override { return part_->distance((p - offset_) * rotation_); }
    Box bounds() const override {
        const Box own = part_->bounds();
        Box box{offset_, offset_};
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                const double m = rotation_[column][row];
                if (m == 0) continue;  // 0 times endless is 0 here
                box.min[row] += std::min(m * own.min[column], m * own.max[column]);
                box.max[row] += std::max(m * own.min[column], m * own.max[column]);
            }
        return box;
    }

private:
    SdfPtr part_;
    glm::dmat3 rotation_;
    glm::dvec3 offset_;
};

class Repetition final : public Sdf {
public:
    Repetition(SdfPtr part, const glm::dvec3& period, int count)
        : part_(std::move(part)), period_(period), count_(count < 0 ? kInfinity : count) {}
    double distance(const glm::dvec3& p) const override {
        // The copy in p's cell, and on each axis the neighbour on the nearer side: the nearest copy is among them,
        // because copies stay in their cells.
        double cells[3][2];
        int choices[3];
        for (int axis = 0; axis < 3; ++axis) {
            cells[axis][0] = 0;
            choices[axis] = 1;
            if (!(period_[axis] > 0)) continue;
            const double place = p[axis] / period_[axis];
            const double nearest = std::clamp(std::round(place), -count_, count_);
            cells[axis][0] = nearest;
            cells[axis][1] = nearest + (place > nearest ? 1 : -1);
            if (std::abs(cells[axis][1]) <= count_) choices[axis] = 2;
        }
        double d = kInfinity;
        for (int x = 0; x < choices[0]; ++x)
            for (int y = 0; y < choices[1]; ++y)
                for (int z = 0; z < choices[2]; ++z)
                    d = std::min(d, part_->distance(p - glm::dvec3(cells[0][x], cells[1][y], cells[2][z]) * period_));
        return d;
    }
    Box bounds() const override {
        Box box = part_->bounds();
        for (int axis = 0; axis < 3; ++axis) {
            if (!(period_[axis] > 0)) continue;
            box.min[axis] -= count_ * period_[axis];
            box.max[axis] += count_ * period_[axis];
        }
        return box;
    }

private:
    SdfPtr part_;
    glm::dvec3 period_;
    double count_;  // a whole number, or infinite
};

}  // namespace

SdfPtr sdfSphere(const glm::dvec3& center, double radius) {
    requirePlace(center, "a sphere's center");
    requireSize(radius, "a sphere's radius");
    return std::make_shared<Sphere>(center, radius);
}

SdfPtr sdfBox(const glm::dvec3& center, const glm::dvec3& half_extents) {
    requirePlace(center, "a box' center");
    for (int axis = 0; axis < 3; ++axis) requireSize(half_extents[axis], "a box' half extent");
    return std::make_shared<BoxShape>(center, half_extents);
}

SdfPtr sdfTorus(const glm::dvec3& center, double radius, double tube, int axis) {
    requirePlace(center, "a torus' center");
    requireSize(radius, "a torus' radius");
    requireSize(tube, "a torus' tube");
    return std::make_shared<Torus>(center, radius, tube, axis);
}

SdfPtr sdfCylinder(const glm::dvec3& center, double radius, double half_height, int axis) {
    requirePlace(center, "a cylinder's center");
    requireSize(radius, "a cylinder's radius");
    requireSize(half_height, "a cylinder's half height");
    return std::make_shared<Cylinder>(center, radius, half_height, axis);
}

SdfPtr sdfPlane(const glm::dvec3& normal, double offset) {
    requirePlace(normal, "a plane's normal");
    requireSize(glm::length(normal), "the length of a plane's normal");
    if (!(std::abs(offset) <= kMost))
        throw UsageError(fmt::format("a plane's offset must be a number of at most {:g}", kMost));
    return std::make_shared<Plane>(glm::normalize(normal), offset);
}

SdfPtr sdfUnion(std::vector<SdfPtr> parts) {
    requireParts(parts, "a union");
    return std::make_shared<Union>(std::move(parts));
}

SdfPtr sdfIntersection(std::vector<SdfPtr> parts) {
    requireParts(parts, "an intersection");
    return std::make_shared<Intersection>(std::move(parts), false);
}

SdfPtr sdfSubtraction(std::vector<SdfPtr> parts) {
    requireParts(parts, "a subtraction");
    return std::make_shared<Intersection>(std::move(parts), true);
}

SdfPtr sdfMoved(SdfPtr part, const glm::dmat3& rotation, const glm::dvec3& offset) {
    requirePlace(offset, "an offset");
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    double off = 0;
    for (int axis = 0; axis < 3; ++axis) off = std::max(off, glm::length(product[axis] - glm::dmat3(1.0)[axis]));
    if (!(off < 1e-9)) throw UsageError("shapes can be turned and moved, not scaled: distances would be wrong");
    return std::make_shared<Moved>(std::move(part), rotation, offset);
}

SdfPtr sdfRepetition(SdfPtr part, const glm::dvec3& period, int count) {
    const Box box = part->bounds();
    for (int axis = 0; axis < 3; ++axis) {
        if (period[axis] == 0) continue;
        requireSize(period[axis], "a period");
        if (!(box.min[axis] >= -0.5 * period[axis] && box.max[axis] <= 0.5 * period[axis]))
            throw UsageError(fmt::format(
                "a shape from {:g} to {:g} along {} can't be repeated every {:g}: it must lie within half a "
                "period of the origin; move or shrink it, or take a longer period",
                box.min[axis], box.max[axis], "xyz"[axis], period[axis]));
    }
    return std::make_shared<Repetition>(std::move(part), period, count);
}

}  // namespace stratum::trace
