// The slow, independent answer to "where does this ray first cross zero": every cell on the way, finely sampled in
// double precision, then halved. Knows nothing of bricks, masks or cubics.
#pragma once

#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace stratum::test {

class BruteMarch {
public:
    explicit BruteMarch(const openvdb::FloatGrid& grid) : grid_(grid), accessor_(grid.getConstAccessor()) {
        box_ = grid.evalActiveVoxelBoundingBox();
        box_.expand(1);
    }

    /// The smallest t in [t_min, t_max] at which the sign of the trilinear field changes, to 1e-13 of the ray's length
    /// in a cell. Two crossings closer than a 200th of a cell's chord may be missed together.
    std::optional<double> operator()(const trace::Ray& ray) {
        const openvdb::Vec3d o = grid_.worldToIndex(openvdb::Vec3d(ray.origin.x, ray.origin.y, ray.origin.z));
        const openvdb::Vec3d e = grid_.worldToIndex(openvdb::Vec3d(
            ray.origin.x + ray.direction.x, ray.origin.y + ray.direction.y, ray.origin.z + ray.direction.z));
        const openvdb::Vec3d d = e - o;
        double t0 = ray.t_min;
        double t1 = ray.t_max;
        for (int axis = 0; axis < 3; ++axis) {
            if (d[axis] == 0) {
                if (o[axis] < box_.min()[axis] || o[axis] > box_.max()[axis]) return std::nullopt;
                continue;
            }
            double near = (box_.min()[axis] - o[axis]) / d[axis];
            double far = (box_.max()[axis] - o[axis]) / d[axis];
            if (near > far) std::swap(near, far);
            t0 = std::max(t0, near);
            t1 = std::min(t1, far);
        }
        if (!(t0 < t1)) return std::nullopt;
        std::vector<double> stops{t0, t1};
        for (int axis = 0; axis < 3; ++axis) {
            if (d[axis] == 0) continue;
            for (int plane = box_.min()[axis]; plane <= box_.max()[axis]; ++plane) {
                const double t = (plane - o[axis]) / d[axis];
                if (t > t0 && t < t1) stops.push_back(t);
            }
        }
        std::sort(stops.begin(), stops.end());
        // The sign is carried from cell to cell: on a face where the field is zero but for rounding, two cells' own
        // evaluations may disagree, and a change must not fall between them.
        std::optional<bool> inside_so_far;
        for (std::size_t n = 0; n + 1 < stops.size(); ++n) {
            const double a = stops[n];
            const double b = stops[n + 1];
            if (!(b > a)) continue;
            const openvdb::Coord cell = openvdb::Coord::floor(o + 0.5 * (a + b) * d);
            double v[8];
            bool mixed = false;
            for (int c = 0; c < 8; ++c) {
                v[c] = static_cast<double>(accessor_.getValue(cell.offsetBy(c >> 2, c >> 1 & 1, c & 1)));
                mixed = mixed || (v[c] < 0) != (v[0] < 0);
            }
            const auto inside = [&](double t) {
                const openvdb::Vec3d p = o + t * d - cell.asVec3d();
                double sum = 0;
                for (int c = 0; c < 8; ++c)
                    sum += v[c] * ((c & 4) != 0 ? p[0] : 1 - p[0]) * ((c & 2) != 0 ? p[1] : 1 - p[1]) *
                           ((c & 1) != 0 ? p[2] : 1 - p[2]);
                return sum < 0;
            };
            const bool first = mixed ? inside(a) : v[0] < 0;
            if (inside_so_far && first != *inside_so_far) return a;
            inside_so_far = first;
            if (!mixed) continue;
            constexpr int kSteps = 200;
            for (int s = 1; s <= kSteps; ++s) {
                double high = a + (b - a) * s / kSteps;
                if (inside(high) == first) continue;
                double low = a + (b - a) * (s - 1) / kSteps;
                for (int halving = 0; halving < 50; ++halving) {
                    const double middle = 0.5 * (low + high);
                    (inside(middle) == first ? low : high) = middle;
                }
                return 0.5 * (low + high);
            }
        }
        return std::nullopt;
    }

private:
    const openvdb::FloatGrid& grid_;
    openvdb::FloatGrid::ConstAccessor accessor_;
    openvdb::CoordBBox box_;
};

}  // namespace stratum::test
