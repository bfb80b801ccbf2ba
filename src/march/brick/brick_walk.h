// One ray through bricks, a block of cells at a time. The scalar path: the oracle of the streams.
//
// Integer cells advance strictly along the ray, so the number of steps is bounded by the number of cells on it, however
// results are rounded; no epsilon is involved. brick_stream.cpp does the same operations in the same order on many
// rays, and its hits have the same bits.
#pragma once

#include "march/brick/brick_grid.h"
#include "march/brick/cell_root.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::march {

/// World space <-> cells. t is the same in both: directions are not normalized again.
struct CellMap {
    glm::dmat3 to_cells{1.0};
    glm::dvec3 origin{0.0};  ///< the origin of world space, in cells

    CellMap(const openvdb::math::MapBase& map, const openvdb::Coord& first_cell) {
        for (int axis = 0; axis < 3; ++axis) {
            openvdb::Vec3d unit(0, 0, 0);
            unit[axis] = 1;
            const openvdb::Vec3d column = map.applyInverseJacobian(unit);
            to_cells[axis] = {column[0], column[1], column[2]};
        }
        const openvdb::Vec3d o = map.applyInverseMap(openvdb::Vec3d(0, 0, 0)) - first_cell.asVec3d();
        origin = {o[0], o[1], o[2]};
    }
};

/// A ray in cells, and its current cell. Inlined into the loop over cells: calls would keep its state in memory.
class Walk {
public:
    /// Both in cells.
    Walk(const glm::dvec3& origin, const glm::dvec3& direction) : origin_(origin), direction_(direction) {
        for (int axis = 0; axis < 3; ++axis) {
            inverse_[axis] = 1 / direction_[axis];
            // Avoids 0 * inf. An axis along which the ray doesn't move, or takes t > 10^308 to cross a cell, has
            // direction and inverse 0 and is skipped.
            if (!std::isfinite(inverse_[axis])) direction_[axis] = inverse_[axis] = 0;
        }
    }

    /// Starts where [t_min, t_max] meets the box of `size` cells; false if it doesn't, or if the ray is no number.
    /// From here on the origin is where the ray meets the box, so that t and what follows from it are small numbers.
    [[gnu::always_inline]] bool enter(double t_min, double t_max, const std::array<int, 3>& size) {
        t_start_ = t_min;
        t_end_ = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const double extent = size[static_cast<std::size_t>(axis)];
            if (direction_[axis] == 0) {
                if (!(origin_[axis] >= 0 && origin_[axis] <= extent)) return false;
                // Keeps the origin below the upper face, so that the upper plane of every cell is ahead.
                origin_[axis] = std::min(origin_[axis], std::nextafter(extent, 0.0));
                continue;
            }
            double near = -origin_[axis] * inverse_[axis];
            double far = (extent - origin_[axis]) * inverse_[axis];
            if (near > far) std::swap(near, far);
            if (!(near <= far)) return false;
            t_start_ = std::max(t_start_, near);
            t_end_ = std::min(t_end_, far);
        }
        if (!(t_start_ <= t_end_) || !std::isfinite(t_start_)) return false;
        origin_ += t_start_ * direction_;
        t_end_ -= t_start_;
        t_ = 0;
        for (int axis = 0; axis < 3; ++axis) {
            cell_[axis] = cellAt(axis, origin_[axis], 0, size[static_cast<std::size_t>(axis)] - 1);
        }
        return true;
    }

    const glm::ivec3& cell() const { return cell_; }
    /// Of the direction.
    Octant octant() const {
        return (direction_.x < 0 ? 4U : 0U) | (direction_.y < 0 ? 2U : 0U) | (direction_.z < 0 ? 1U : 0U);
    }
    /// Of the ray's own t, where the current cell is entered and left. aim() must have been called for the cell.
    double at(double s) const { return t_start_ + (t_ + s * (std::min(t_exit_, t_end_) - t_)); }

    /// Finds where the ray leaves the block [low, high) of cells that it is in.
    [[gnu::always_inline]] void aim(const glm::ivec3& low, const glm::ivec3& high) {
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

    /// Advances to the exit found by aim(); false at the end of the ray or of the box.
    [[gnu::always_inline]] bool advance(const glm::ivec3& low, const glm::ivec3& high, const std::array<int, 3>& size) {
        if (t_exit_ >= t_end_) return false;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = direction_[axis];
            if (axis == exit_axis_) {
                cell_[axis] = d > 0 ? high[axis] : low[axis] - 1;
            } else if (d != 0) {
                const int least = d > 0 ? cell_[axis] : low[axis];
                const int most = d > 0 ? high[axis] - 1 : cell_[axis];
                cell_[axis] = cellAt(axis, positionAt(axis, t_exit_), least, most);
            }
        }
        t_ = t_exit_;
        entry_axis_ = exit_axis_;
        const int reached = cell_[exit_axis_];
        return reached >= 0 && reached < size[static_cast<std::size_t>(exit_axis_)];
    }

    /// Entry and exit of the current cell in its own coordinates; the face that is crossed is exactly 0 or 1, so that
    /// the neighbour evaluates the same point. aim() must have been called for the cell.
    glm::dvec3 localEntry() const { return local(t_, entry_axis_, true); }
    glm::dvec3 localExit() const {
        return t_exit_ <= t_end_ ? local(t_exit_, exit_axis_, false) : local(t_end_, -1, false);
    }

private:
    // The cell of a position, in [least, most], least >= 0. On a plane between two cells: the one ahead of the ray.
    int cellAt(int axis, double position, int least, int most) const {
        const double x = std::clamp<double>(position, least, most + 1);
        const int floor = static_cast<int>(x);
        return std::clamp(direction_[axis] < 0 && floor == x ? floor - 1 : floor, least, most);
    }
    double positionAt(int axis, double t) const { return origin_[axis] + t * direction_[axis]; }

    glm::dvec3 local(double t, int face_axis, bool entry) const {
        glm::dvec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = std::clamp(positionAt(axis, t) - cell_[axis], 0.0, 1.0);
        if (face_axis >= 0) p[face_axis] = (direction_[face_axis] > 0) == entry ? 0.0 : 1.0;
        return p;
    }

    glm::dvec3 origin_;
    glm::dvec3 direction_;
    glm::dvec3 inverse_{0.0};
    glm::ivec3 cell_{0};
    double t_start_ = 0;  // the ray's own t at origin_
    double t_ = 0, t_end_ = 0, t_exit_ = 0;
    int entry_axis_ = -1, exit_axis_ = 0;  // -1: the ray begins inside a cell
};

/// The largest known block around a cell without surface cells, or the cell itself if it is a surface cell.
struct Block {
    glm::ivec3 low, high;
    std::size_t brick;
    bool surface;
};

[[gnu::always_inline]] inline Block findBlock(const BrickGrid& grid, const glm::ivec3& cell, Octant octant = 0) {
    const glm::ivec3 size(grid.size()[0], grid.size()[1], grid.size()[2]);
    constexpr int kMacroShift = 5;
    const glm::ivec3 m = cell >> kMacroShift;
    const MacroCell& macro = grid.macroCell(m.x, m.y, m.z);
    if (macro.bricks == 0) {
        const int more = macro.emptyAhead(octant) - 1;
        const glm::ivec3 back((octant & 4) != 0 ? more : 0, (octant & 2) != 0 ? more : 0, (octant & 1) != 0 ? more : 0);
        return {glm::max((m - back) << kMacroShift, glm::ivec3(0)),
                glm::min((m + (more + 1) - back) << kMacroShift, size), 0, false};
    }
    const auto aligned = [&cell](int edge) {
        const glm::ivec3 low = cell & ~(edge - 1);
        return Block{low, low + edge, 0, false};
    };
    const glm::ivec3 b = cell >> 3 & 3;
    if (const int edge = Mask64::emptyEdge(macro.bricks, b.x, b.y, b.z, octant))
        return aligned(edge * BrickGrid::kBrickEdge);
    const std::size_t brick = BrickGrid::brickIndex(macro, b.x, b.y, b.z);
    const glm::ivec3 half = cell >> 2 & 1;
    const auto part = static_cast<std::size_t>(half.x << 2 | half.y << 1 | half.z);
    const glm::ivec3 c = cell & 3;
    std::uint64_t word = grid.surface(brick, part);
    if (grid.lazy()) [[unlikely]]
        if ((word >> Mask64::bit(c.x, c.y, c.z) & 1) != 0) word = grid.ensureSurface(brick, part, cell);
    if (const int edge = Mask64::emptyEdge(word, c.x, c.y, c.z, octant)) return aligned(edge);
    return {cell, cell + 1, brick, true};
}

/// In the units of the grid's samples: zero crossings and their directions don't depend on the unit.
[[gnu::always_inline]] inline Corners cornersOf(const BrickGrid& grid, std::size_t brick, const glm::ivec3& cell) {
    constexpr auto kX = BrickGrid::kStrideX;
    constexpr auto kY = BrickGrid::kStrideY;
    const auto first =
        static_cast<std::ptrdiff_t>(grid.firstSample(brick)) + (cell.x & 7) * kX + (cell.y & 7) * kY + (cell.z & 7);
    const auto from = [](const auto* v) -> Corners {
        const auto at = [v](std::ptrdiff_t n) { return sampleOf(v[n]); };
        return {at(0), at(1), at(kY), at(kY + 1), at(kX), at(kX + 1), at(kX + kY), at(kX + kY + 1)};
    };
    return grid.values() == BrickValues::Float32 ? from(grid.floats() + first) : from(grid.quanta() + first);
}

}  // namespace stratum::march
