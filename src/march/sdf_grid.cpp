#include "march/sdf_grid.h"

#include "io/error.h"
#include "parallel/parallel_for.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace stratum::march {
namespace {

constexpr double kHalfWidth = 3;  // voxels
constexpr int kLeaf = 8;          // voxels

using Leaf = openvdb::FloatTree::LeafNodeType;

}  // namespace

openvdb::FloatGrid::Ptr makeSdfGrid(const Sdf& shape, double voxel_size) {
    if (!(voxel_size > 0 && std::isfinite(voxel_size)))
        throw UsageError(
            fmt::format("the voxel size of a shape is {}; it must be a finite number above 0", voxel_size));
    const Box box = shape.bounds();
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
    // Columns of leaves along z, each by one thread; put together in their order.
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
                for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
                    const openvdb::Vec3d p = leaf->offsetToGlobalCoord(n).asVec3d() * voxel_size;
                    const double d = shape.distance({p[0], p[1], p[2]});
                    const double kept = std::clamp(d, -background, background);
                    if (std::abs(d) < background)
                        leaf->setValueOn(n, static_cast<float>(kept));
                    else
                        leaf->setValueOff(n, static_cast<float>(kept));
                }
                if (!leaf->isEmpty()) columns[column].push_back(std::move(leaf));
            }
        }
    });
    auto grid = openvdb::FloatGrid::create(static_cast<float>(background));
    for (auto& column : columns)
        for (auto& leaf : column) grid->tree().addLeaf(leaf.release());
    if (grid->tree().leafCount() == 0)
        throw UsageError(fmt::format("nothing of the shape is left on voxels of {}; take smaller ones", voxel_size));
    openvdb::tools::signedFloodFill(grid->tree());
    grid->setName("surface");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
    return grid;
}

}  // namespace stratum::march
