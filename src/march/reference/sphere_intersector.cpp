#include "march/reference/reference_intersectors.h"

#include "march/brick/cell_root.h"
#include "march/file/grid_axes.h"
#include "march/file/level_set_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::march {
namespace {

constexpr double kArrived = 1e-3;  // voxels
constexpr int kMostSteps = 2000;   // in the narrow band
constexpr double kNudge = 1e-6;    // voxels, out of an empty node: no hit lies there

// As the grid's metadata state it, within reason; 1 otherwise.
double largestSlope(const openvdb::FloatGrid& grid) {
    const auto stated = grid.getMetadata<openvdb::DoubleMetadata>("largest_slope");
    constexpr double kMost = 100;
    return stated && stated->value() >= 1 ? std::min(stated->value(), kMost) : 1.0;
}

class SphereTracer final : public trace::Tracer {
public:
    SphereTracer(const openvdb::FloatGrid& grid, const GridAxes& axes, const openvdb::math::MapBase& map,
                 const openvdb::CoordBBox& box, double relaxation)
        : map_(map),
          box_(box),
          accessor_(grid.getConstAccessor()),
          voxel_(axes.shortest()),
          tame_(axes.shortest() / axes.longest() / largestSlope(grid)),
          relaxation_(relaxation) {}

    bool intersect(const trace::Ray& ray, trace::Hit& hit) override {
        double s = 0;
        if (!nearest(ray, s)) return false;
        hit.t = s * voxel_;
        hit.position = ray.origin + hit.t * ray.direction;
        Corners corners;
        const glm::dvec3 p = origin_ + place_ * direction_;
        const openvdb::Coord cell = load(p, corners);
        const glm::dvec3 g = gradient(corners, p - glm::dvec3(cell[0], cell[1], cell[2]));
        openvdb::Vec3d normal = map_.applyIJT(openvdb::Vec3d(g.x, g.y, g.z));
        if (normal.normalize(1e-30))
            hit.normal = {normal[0], normal[1], normal[2]};
        else
            hit.normal = -ray.direction;
        return true;
    }
    bool occluded(const trace::Ray& ray) override {
        double s = 0;
        return nearest(ray, s);
    }

private:
    openvdb::Coord load(const glm::dvec3& p, Corners& corners) {
        const openvdb::Coord cell = openvdb::Coord::floor(openvdb::Vec3d(p.x, p.y, p.z));
        for (int c = 0; c < 8; ++c)
            corners[static_cast<std::size_t>(c)] =
                static_cast<double>(accessor_.getValue(cell.offsetBy(c >> 2, c >> 1 & 1, c & 1)));
        return cell;
    }
    // In voxels.
    double field(double s) {
        Corners corners;
        const glm::dvec3 p = origin_ + s * direction_;
        const openvdb::Coord cell = load(p, corners);
        return interpolate(corners, p - glm::dvec3(cell[0], cell[1], cell[2])) / voxel_;
    }
    // Edge of the empty node of the tree around a cell; 0 if there is a leaf.
    int emptyEdge(const openvdb::Coord& cell) {
        if (accessor_.probeConstLeaf(cell) != nullptr) return 0;
        using Tree = openvdb::FloatTree;
        constexpr int kLeaf = 8;
        constexpr int kNode = 128;
        return accessor_.probeConstNode<Tree::RootNodeType::ChildNodeType::ChildNodeType>(cell) != nullptr ? kLeaf
                                                                                                           : kNode;
    }
    // Where the ray leaves the aligned block of `edge` cells around p.
    double leave(const glm::dvec3& p, const openvdb::Coord& cell, int edge, double s) {
        double step = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const double d = direction_[axis];
            if (d == 0) continue;
            const int low = cell[axis] & ~(edge - 1);
            const double way = ((d > 0 ? low + edge : low) - p[axis]) / d;
            if (!(way > 0)) {
                // On the exit face, possibly so slow that no step along the ray crosses it: the position is moved
                // across instead.
                origin_[axis] += std::copysign(kNudge, d);
                return s;
            }
            step = std::min(step, way);
        }
        return s + step + kNudge;
    }

    bool isNearBox(const glm::dvec3& p) const {
        constexpr int kNear = 2;  // voxels
        for (int axis = 0; axis < 3; ++axis)
            if (!(p[axis] >= box_.min()[axis] - kNear && p[axis] <= box_.max()[axis] + kNear)) return false;
        return true;
    }

    // s in voxels from the ray's origin.
    bool nearest(const trace::Ray& ray, double& hit) {
        const openvdb::Vec3d o = map_.applyInverseMap(openvdb::Vec3d(ray.origin.x, ray.origin.y, ray.origin.z));
        const openvdb::Vec3d d =
            map_.applyInverseJacobian(openvdb::Vec3d(ray.direction.x, ray.direction.y, ray.direction.z));
        origin_ = {o[0], o[1], o[2]};
        direction_ = voxel_ * glm::dvec3(d[0], d[1], d[2]);
        double s = ray.t_min / voxel_;
        double end = ray.t_max / voxel_;
        for (int axis = 0; axis < 3; ++axis) {
            if (!std::isfinite(origin_[axis]) || !std::isfinite(direction_[axis])) return false;
            const double low = box_.min()[axis] - 1;
            const double high = box_.max()[axis] + 1;
            if (direction_[axis] == 0) {
                if (origin_[axis] < low || origin_[axis] > high) return false;
                continue;
            }
            const double a = (low - origin_[axis]) / direction_[axis];
            const double b = (high - origin_[axis]) / direction_[axis];
            s = std::max(s, std::min(a, b));
            end = std::min(end, std::max(a, b));
        }
        // Measured from the box, so that s is small even for a distant eye and small steps are not lost in rounding.
        const double start = s;
        if (!(start <= end) || !std::isfinite(end)) return false;
        origin_ += start * direction_;
        end -= start;
        s = 0;
        // So far away that the rounding error is voxels: its entry into the box is undefined.
        if (!isNearBox(origin_) || !isNearBox(origin_ + end * direction_)) return false;
        if (!march(end, s)) return false;
        hit = start + s;
        place_ = s;
        return true;
    }

    bool march(double end, double& hit) {
        double s = 0;
        double last_radius = 0;  // at the last position in the band, and the step from there
        double last_step = 0;
        double omega = relaxation_;
        bool begun = false;
        bool inside = false;
        double before = s;  // a position with the first sign
        for (int step = 0; step < kMostSteps && s <= end;) {
            const glm::dvec3 p = origin_ + s * direction_;
            const openvdb::Coord cell = openvdb::Coord::floor(openvdb::Vec3d(p.x, p.y, p.z));
            if (const int edge = emptyEdge(cell)) {
                before = s;
                s = leave(p, cell, edge, s);
                last_step = last_radius = 0;
                continue;
            }
            ++step;
            const double phi = field(s);
            const double radius = tame_ * std::abs(phi);
            if (begun && isInside(phi) != inside) {
                // The sign changes between two positions, because the field may change faster than distance: bisect.
                double low = before;
                double high = s;
                for (int halving = 0; halving < 60 && high - low > kArrived * 1e-3; ++halving) {
                    const double middle = 0.5 * (low + high);
                    (isInside(field(middle)) == inside ? low : high) = middle;
                }
                hit = high;
                return true;
            }
            if (omega > 1 && last_step > 0 && last_radius + radius < last_step) {
                // The two spheres don't overlap: a surface may be in between. Back, with steps without relaxation from
                // here.
                s -= last_step - last_radius;
                omega = 1;
                last_step = 0;
                continue;
            }
            // A ray may start nearer than that to the surface that it leaves: it hits only while the distance
            // decreases.
            if (radius < kArrived && begun && radius <= last_radius) {
                hit = s;
                return true;
            }
            if (!begun) inside = isInside(phi);
            begun = true;
            before = s;
            last_radius = radius;
            last_step = std::max(omega * radius, 0.5 * kArrived);
            omega = relaxation_;
            s += last_step;
        }
        return false;
    }

    const openvdb::math::MapBase& map_;
    const openvdb::CoordBBox box_;
    openvdb::FloatGrid::ConstAccessor accessor_;
    const double voxel_;  // shortest edge, world units; s counts these along the ray
    const double tame_;   // values times this change no faster than distance
    const double relaxation_;
    glm::dvec3 origin_{0.0}, direction_{0.0};  // of the ray under way, in index space, from where it meets the box
    double place_ = 0;                         // of its hit, from there
};

class SphereIntersector final : public trace::Intersector {
public:
    SphereIntersector(openvdb::FloatGrid::ConstPtr grid, double relaxation)
        : grid_(std::move(grid)),
          axes_(grid_->transform()),
          map_(grid_->transform().baseMap()),
          box_(grid_->evalActiveVoxelBoundingBox()),
          bounds_(narrowBandBounds(*grid_)),
          relaxation_(relaxation) {}

    std::unique_ptr<trace::Tracer> makeTracer() const override {
        return std::make_unique<SphereTracer>(*grid_, axes_, *map_, box_, relaxation_);
    }
    std::string_view name() const override { return "sphere"; }
    trace::Box bounds() const override { return bounds_; }
    double voxelSize() const override { return axes_.shortest(); }
    std::size_t bytes() const override { return 0; }
    // Farther than the distance at which rays hit.
    double surfaceOffset() const override { return 0.02 * voxelSize(); }

private:
    openvdb::FloatGrid::ConstPtr grid_;
    GridAxes axes_;
    openvdb::math::MapBase::ConstPtr map_;
    openvdb::CoordBBox box_;
    trace::Box bounds_;
    double relaxation_;
};

}  // namespace

std::unique_ptr<trace::Intersector> makeSphereIntersector(openvdb::FloatGrid::ConstPtr grid, double relaxation) {
    requireTraceable(*grid, grid->getName());
    return std::make_unique<SphereIntersector>(std::move(grid), relaxation);
}

}  // namespace stratum::march
