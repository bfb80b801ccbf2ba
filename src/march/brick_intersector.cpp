#include "march/brick_intersector.h"

#include "march/brick_grid.h"
#include "march/cell_root.h"
#include "march/level_set_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::march {
namespace {

glm::dvec3 toGlm(const openvdb::Vec3d& v) { return {v[0], v[1], v[2]}; }

// World space <-> cells. t is the same in both: directions are not normalized again.
struct CellMap {
    glm::dmat3 to_cells{1.0};
    glm::dvec3 origin{0.0};  // of world space, in cells

    CellMap(const openvdb::math::MapBase& map, const openvdb::Coord& first_cell) {
        for (int axis = 0; axis < 3; ++axis) {
            openvdb::Vec3d unit(0, 0, 0);
            unit[axis] = 1;
            to_cells[axis] = toGlm(map.applyInverseJacobian(unit));
        }
        origin = toGlm(map.applyInverseMap(openvdb::Vec3d(0, 0, 0)) - first_cell.asVec3d());
    }
};

// A ray in cells, and where it is. Integer cells advance strictly along the ray, so a walk ends after no more steps
// than there are cells on its way, whatever the rounding; nothing is pushed by an epsilon.
class Walk {
public:
    Walk(const glm::dvec3& origin, const glm::dvec3& direction) : origin_(origin), direction_(direction) {
        for (int axis = 0; axis < 3; ++axis)
            // Never 0 * inf: an axis along which the ray doesn't move is skipped by its sign.
            inverse_[axis] = direction[axis] != 0 ? 1 / direction[axis] : 0;
    }

    // Starts where [t_min, t_max] meets the box of `size` cells; false if it doesn't.
    bool enter(double t_min, double t_max, const std::array<int, 3>& size) {
        t_ = t_min;
        t_end_ = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const double extent = size[static_cast<std::size_t>(axis)];
            if (direction_[axis] == 0) {
                if (!(origin_[axis] >= 0 && origin_[axis] <= extent)) return false;
                continue;
            }
            double near = -origin_[axis] * inverse_[axis];
            double far = (extent - origin_[axis]) * inverse_[axis];
            if (near > far) std::swap(near, far);
            t_ = std::max(t_, near);
            t_end_ = std::min(t_end_, far);
        }
        if (!(t_ <= t_end_)) return false;
        for (int axis = 0; axis < 3; ++axis)
            cell_[axis] =
                std::clamp(static_cast<int>(std::floor(at(axis, t_))), 0, size[static_cast<std::size_t>(axis)] - 1);
        return true;
    }

    const glm::ivec3& cell() const { return cell_; }
    double t() const { return t_; }
    double tEnd() const { return t_end_; }

    // Finds where the ray leaves the block [low, high) of cells that it is in.
    void aim(const glm::ivec3& low, const glm::ivec3& high) {
        t_exit_ = std::numeric_limits<double>::infinity();
        exit_axis_ = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (direction_[axis] == 0) continue;
            const double plane = direction_[axis] > 0 ? high[axis] : low[axis];
            const double t = (plane - origin_[axis]) * inverse_[axis];
            if (t < t_exit_) {
                t_exit_ = t;
                exit_axis_ = axis;
            }
        }
        t_exit_ = std::max(t_exit_, t_);
    }

    // Goes there; false at the end of the ray or of the box.
    bool advance(const glm::ivec3& low, const glm::ivec3& high, const std::array<int, 3>& size) {
        if (t_exit_ >= t_end_) return false;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = direction_[axis];
            if (axis == exit_axis_) {
                cell_[axis] = d > 0 ? high[axis] : low[axis] - 1;
            } else if (d != 0) {
                const int there = static_cast<int>(std::floor(at(axis, t_exit_)));
                cell_[axis] =
                    d > 0 ? std::clamp(there, cell_[axis], high[axis] - 1) : std::clamp(there, low[axis], cell_[axis]);
            }
        }
        t_ = t_exit_;
        entry_axis_ = exit_axis_;
        const int reached = cell_[exit_axis_];
        return reached >= 0 && reached < size[static_cast<std::size_t>(exit_axis_)];
    }

    // Entry and exit of the current cell in its own coordinates; the face that is crossed is exactly 0 or 1, so that
    // the neighbour evaluates the same point. aim() must have been called for the cell.
    glm::dvec3 localEntry() const { return local(t_, entry_axis_, true); }
    glm::dvec3 localExit() const {
        return t_exit_ <= t_end_ ? local(t_exit_, exit_axis_, false) : local(t_end_, -1, false);
    }
    double tExit() const { return std::min(t_exit_, t_end_); }

private:
    double at(int axis, double t) const { return origin_[axis] + t * direction_[axis]; }

    glm::dvec3 local(double t, int face_axis, bool entry) const {
        glm::dvec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = std::clamp(at(axis, t) - cell_[axis], 0.0, 1.0);
        if (face_axis >= 0) p[face_axis] = (direction_[face_axis] > 0) == entry ? 0.0 : 1.0;
        return p;
    }

    const glm::dvec3 origin_;
    const glm::dvec3 direction_;
    glm::dvec3 inverse_;
    glm::ivec3 cell_{0};
    double t_ = 0, t_end_ = 0, t_exit_ = 0;
    int entry_axis_ = -1, exit_axis_ = 0;  // -1: the ray begins inside a cell
};

// The largest block around a cell that is known to hold no surface cell, or the cell itself if it is one.
struct Block {
    glm::ivec3 low, high;
    std::size_t brick;
    bool surface;
};

Block findBlock(const BrickGrid& grid, const glm::ivec3& cell) {
    const glm::ivec3 size(grid.size()[0], grid.size()[1], grid.size()[2]);
    constexpr int kMacroShift = 5;
    const glm::ivec3 m = cell >> kMacroShift;
    const MacroCell& macro = grid.macroCell(m.x, m.y, m.z);
    if (macro.bricks == 0) {
        const int radius = static_cast<int>(macro.empty_radius);
        return {glm::max((m - (radius - 1)) << kMacroShift, glm::ivec3(0)), glm::min((m + radius) << kMacroShift, size),
                0, false};
    }
    const auto aligned = [&cell](int edge) {
        const glm::ivec3 low = cell & ~(edge - 1);
        return Block{low, low + edge, 0, false};
    };
    const glm::ivec3 b = cell >> 3 & 3;
    if (const int edge = Mask64::emptyEdge(macro.bricks, b.x, b.y, b.z)) return aligned(edge * BrickGrid::kBrickEdge);
    const std::size_t brick = BrickGrid::brickIndex(macro, b.x, b.y, b.z);
    const glm::ivec3 half = cell >> 2 & 1;
    const std::uint64_t word = grid.surface(brick)[static_cast<std::size_t>(half.x << 2 | half.y << 1 | half.z)];
    const glm::ivec3 c = cell & 3;
    if (const int edge = Mask64::emptyEdge(word, c.x, c.y, c.z)) return aligned(edge);
    return {cell, cell + 1, brick, true};
}

Corners cornersOf(const BrickGrid& grid, std::size_t brick, const glm::ivec3& cell) {
    constexpr auto kX = BrickGrid::kStrideX;
    constexpr auto kY = BrickGrid::kStrideY;
    const float* v = grid.samples(brick) + (cell.x & 7) * kX + (cell.y & 7) * kY + (cell.z & 7);
    return {v[0], v[1], v[kY], v[kY + 1], v[kX], v[kX + 1], v[kX + kY], v[kX + kY + 1]};
}

class BrickTracer final : public Tracer {
public:
    BrickTracer(const BrickGrid& grid, const CellMap& map) : grid_(grid), map_(map) {}

    bool intersect(const Ray& ray, Hit& hit) override { return trace(ray, &hit); }
    bool occluded(const Ray& ray) override { return trace(ray, nullptr); }

private:
    // With `hit` the nearest root is refined; without, the first sign change is enough.
    bool trace(const Ray& ray, Hit* hit) const {
        Walk walk(map_.to_cells * ray.origin + map_.origin, map_.to_cells * ray.direction);
        if (!walk.enter(ray.t_min, ray.t_max, grid_.size())) return false;
        while (true) {
            const Block block = findBlock(grid_, walk.cell());
            walk.aim(block.low, block.high);
            if (block.surface) {
                const Corners corners = cornersOf(grid_, block.brick, walk.cell());
                const glm::dvec3 from = walk.localEntry();
                const glm::dvec3 to = walk.localExit();
                const SegmentCubic field(corners, from, to);
                if (const auto bracket = firstCrossing(field)) {
                    if (hit != nullptr) report(ray, walk, corners, from, to, refineRoot(field, *bracket), *hit);
                    return true;
                }
            }
            if (!walk.advance(block.low, block.high, grid_.size())) return false;
        }
    }

    void report(const Ray& ray, const Walk& walk, const Corners& corners, const glm::dvec3& from, const glm::dvec3& to,
                double s, Hit& hit) const {
        hit.t = walk.t() + s * (walk.tExit() - walk.t());
        hit.position = ray.origin + hit.t * ray.direction;
        // Gradients transform by the transpose of the map to cells.
        const glm::dvec3 normal = gradient(corners, from + s * (to - from)) * map_.to_cells;
        const double length = glm::length(normal);
        // A gradient that vanishes gives no direction; facing the ray keeps everything downstream finite.
        hit.normal = length > 0 ? normal / length : -ray.direction;
    }

    const BrickGrid& grid_;
    const CellMap& map_;
};

class BrickIntersector final : public Intersector {
public:
    explicit BrickIntersector(const openvdb::FloatGrid& grid)
        : bricks_(grid),
          map_(*grid.transform().baseMap(), bricks_.origin()),
          bounds_(narrowBandBounds(grid)),
          voxel_size_(grid.voxelSize()[0]) {}

    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<BrickTracer>(bricks_, map_); }
    std::string_view name() const override { return "brick"; }
    Box bounds() const override { return bounds_; }
    double voxelSize() const override { return voxel_size_; }
    // Hits are exact, so a thousandth of a voxel clears the surface; it is far above the rounding of doubles for any
    // part that OpenVDB can index.
    double surfaceOffset() const override { return 1e-3 * voxel_size_; }
    std::size_t bytes() const override { return bricks_.bytes(); }

private:
    BrickGrid bricks_;
    CellMap map_;
    Box bounds_;
    double voxel_size_;
};

}  // namespace

std::unique_ptr<Intersector> makeBrickIntersector(const openvdb::FloatGrid& grid) {
    requireTraceable(grid, grid.getName());
    return std::make_unique<BrickIntersector>(grid);
}

}  // namespace stratum::march
