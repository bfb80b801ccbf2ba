#include "march/file/sdf_grid.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace stratum::march {
namespace {

constexpr double kHalfWidth = 3;  // voxels
constexpr int kLeaf = 8;          // voxels

using Leaf = openvdb::FloatTree::LeafNodeType;

// Bytes of a leaf and its share of the nodes above.
constexpr double kBytesPerLeaf = 2048 + 160;
// The upper nodes of even a small grid: around the origin there are eight, of 32^3 pointers each.
constexpr double kBytesOfTree = 2.2e6;

struct LeafBox {
    openvdb::Coord low;     // of its first leaf, voxels
    std::size_t leaves[3];  // along each axis
};

// Estimates the number of leaves that the surface crosses: blocks of leaves near the surface are subdivided until there
// are many; then each counts as many leaves as a plane through it crosses.
double estimateLeaves(const trace::Sdf& shape, double voxel_size, const LeafBox& box) {
    constexpr std::size_t kMany = 20000;
    struct Block {
        std::int64_t x, y, z;  // in blocks
    };
    std::int64_t size = 1;  // of a block, in leaves
    while (size < static_cast<std::int64_t>(std::max({box.leaves[0], box.leaves[1], box.leaves[2]}))) size *= 2;
    std::vector<Block> blocks{{0, 0, 0}};
    while (size > 1 && !blocks.empty() && blocks.size() < kMany) {
        size /= 2;
        std::vector<Block> halves;
        const double edge = static_cast<double>(size * kLeaf) * voxel_size;
        const double reach = kHalfWidth * voxel_size + std::sqrt(3.0) * 0.5 * edge;
        for (const Block& block : blocks)
            for (int corner = 0; corner < 8; ++corner) {
                const Block half{2 * block.x + (corner & 1), 2 * block.y + (corner >> 1 & 1),
                                 2 * block.z + (corner >> 2)};
                if (half.x * size >= static_cast<std::int64_t>(box.leaves[0]) ||
                    half.y * size >= static_cast<std::int64_t>(box.leaves[1]) ||
                    half.z * size >= static_cast<std::int64_t>(box.leaves[2]))
                    continue;
                const glm::dvec3 middle{box.low.x() * voxel_size + (static_cast<double>(half.x) + 0.5) * edge,
                                        box.low.y() * voxel_size + (static_cast<double>(half.y) + 0.5) * edge,
                                        box.low.z() * voxel_size + (static_cast<double>(half.z) + 0.5) * edge};
                if (std::abs(shape.distance(middle)) <= reach) halves.push_back(half);
            }
        blocks = std::move(halves);
    }
    return static_cast<double>(blocks.size()) * static_cast<double>(size) * static_cast<double>(size);
}

// Both lists and leaves; throws UsageError with a voxel that fits.
void refuseIfTooLarge(const trace::Sdf& shape, double voxel_size, const LeafBox& box, double width,
                      std::size_t memory_limit) {
    // As of lists of beads: what takes more has a wrong number in it more often than not, and takes minutes.
    constexpr std::size_t kShareOfMemory = 4;
    const auto limit = static_cast<double>(memory_limit != 0 ? memory_limit : availableMemory() / kShareOfMemory);
    const double columns = static_cast<double>(box.leaves[0]) * static_cast<double>(box.leaves[1]);
    const double bytes = kBytesOfTree + estimateLeaves(shape, voxel_size, box) * kBytesPerLeaf +
                         columns * static_cast<double>(sizeof(std::vector<std::unique_ptr<Leaf>>));
    if (bytes > limit)
        throw UsageError(
            fmt::format("a shape {:.3g} wide in voxels of {:g} takes about {:.3g} GB, and may take {:.3g} GB here; "
                        "take a voxel_size "
                        "of {:.2g} or more, or leave it out and trace the shape as it is",
                        width, voxel_size, bytes * 1e-9, limit * 1e-9, 1.2 * voxel_size * std::sqrt(bytes / limit)));
}

}  // namespace

openvdb::FloatGrid::Ptr makeSdfGrid(const trace::Sdf& shape, double voxel_size, std::size_t memory_limit) {
    if (!(voxel_size > 0 && std::isfinite(voxel_size)))
        throw UsageError(
            fmt::format("the voxel size of a shape is {}; it must be a finite number above 0", voxel_size));
    const trace::Box box = shape.bounds();
    openvdb::Coord low;
    double count[3];
    double leaves = 1;
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis]))
            throw UsageError("a shape without an end can't be voxelized; leave out voxel_size and trace it as it is");
        const double first = std::floor((box.min[axis] / voxel_size - kHalfWidth) / kLeaf);
        const double last = std::floor((box.max[axis] / voxel_size + kHalfWidth) / kLeaf);
        count[axis] = last - first + 1;
        leaves *= count[axis];
        if (!(std::abs(first) < 1e8 && std::abs(last) < 1e8 && leaves < 2147483648.0))
            throw UsageError(fmt::format("voxels of {} are too small for a shape {} wide; take larger ones", voxel_size,
                                         box.max[axis] - box.min[axis]));
        low[axis] = static_cast<int>(first) * kLeaf;
    }
    const double background = kHalfWidth * voxel_size;
    const double reach = background + std::sqrt(3.0) * 0.5 * (kLeaf - 1) * voxel_size;
    const auto nx = static_cast<std::size_t>(count[0]);
    const auto ny = static_cast<std::size_t>(count[1]);
    const auto nz = static_cast<std::size_t>(count[2]);
    refuseIfTooLarge(shape, voxel_size, {low, {nx, ny, nz}}, box.max[0] - box.min[0], memory_limit);
    // Columns of leaves along z, each by one thread; joined in order.
    std::atomic<bool> has_inside{false};
    std::vector<std::vector<std::unique_ptr<Leaf>>> columns(nx * ny);
    parallelFor(columns.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t column = begin; column != end; ++column) {
            for (std::size_t z = 0; z < nz; ++z) {
                const openvdb::Coord origin =
                    low.offsetBy(static_cast<int>(column / ny) * kLeaf, static_cast<int>(column % ny) * kLeaf,
                                 static_cast<int>(z) * kLeaf);
                const openvdb::Vec3d middle = (origin.asVec3d() + openvdb::Vec3d(0.5 * (kLeaf - 1))) * voxel_size;
                if (std::abs(shape.distance({middle[0], middle[1], middle[2]})) > reach) continue;
                auto leaf = std::make_unique<Leaf>(origin, static_cast<float>(background));
                bool inside = false;
                for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
                    const openvdb::Vec3d p = leaf->offsetToGlobalCoord(n).asVec3d() * voxel_size;
                    const double d = shape.distance({p[0], p[1], p[2]});
                    const double kept = std::clamp(d, -background, background);
                    inside = inside || d < 0.0;
                    if (std::abs(d) < background)
                        leaf->setValueOn(n, static_cast<float>(kept));
                    else
                        leaf->setValueOff(n, static_cast<float>(kept));
                }
                if (inside) has_inside.store(true, std::memory_order_relaxed);
                if (!leaf->isEmpty()) columns[column].push_back(std::move(leaf));
            }
        }
    });
    auto grid = openvdb::FloatGrid::create(static_cast<float>(background));
    for (auto& column : columns)
        for (auto& leaf : column) grid->tree().addLeaf(leaf.release());
    // A shape between the samples has a narrow band, too, but no surface.
    if (!has_inside)
        throw UsageError(
            fmt::format("nothing of a shape {:.3g} x {:.3g} x {:.3g} large is left on voxels of {:g}; take a smaller "
                        "voxel_size, or leave it out and trace the shape as it is",
                        box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2], voxel_size));
    openvdb::tools::signedFloodFill(grid->tree());
    grid->setName("surface");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
    return grid;
}

}  // namespace stratum::march
