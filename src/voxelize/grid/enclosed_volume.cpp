#include "voxelize/grid/enclosed_volume.h"

#include "base/parallel_for.h"
#include "voxelize/grid/cell_volume.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stratum::voxelize {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
void gather(const Leaf& leaf, openvdb::tree::ValueAccessor<const openvdb::FloatTree>& tree, LeafSamples& samples) {
    const float* values = leaf.buffer().data();
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y, values += 8) std::copy_n(values, 8, samples.v[x][y]);
    for (int corner = 1; corner < 8; ++corner) {
        const openvdb::Coord step(corner & 1, corner >> 1 & 1, corner >> 2);
        const openvdb::Coord origin = leaf.origin() + openvdb::Coord(8 * step[0], 8 * step[1], 8 * step[2]);
        const Leaf* next = tree.probeConstLeaf(origin);
        const float all = next == nullptr ? tree.getValue(origin) : 0.0F;
        for (int x = 0; x < (step[0] != 0 ? 1 : 8); ++x)
            for (int y = 0; y < (step[1] != 0 ? 1 : 8); ++y)
                for (int z = 0; z < (step[2] != 0 ? 1 : 8); ++z)
                    samples.v[x + 8 * step[0]][y + 8 * step[1]][z + 8 * step[2]] =
                        next != nullptr ? next->buffer().data()[(x * 8 + y) * 8 + z] : all;
    }
}

}  // namespace

double enclosedVolume(const openvdb::FloatGrid& grid, std::size_t most_leaves) {
    const openvdb::tree::LeafManager<const openvdb::FloatTree> leaves(grid.tree());
    std::vector<std::size_t> picked;
    picked.reserve(std::min(leaves.leafCount(), most_leaves));
    for (std::size_t n = 0; n < leaves.leafCount(); ++n)
        if (leaves.leafCount() <= most_leaves || scattered(n) % leaves.leafCount() < most_leaves) picked.push_back(n);
    // One sum a leaf, added in order: the same value for any number of threads.
    std::vector<double> sums(picked.size());
    parallelFor(sums.size(), 64, [&](std::size_t first, std::size_t last) {
        openvdb::tree::ValueAccessor<const openvdb::FloatTree> tree(grid.tree());
        LeafSamples samples;
        for (std::size_t n = first; n != last; ++n) {
            gather(leaves.leaf(picked[n]), tree, samples);
            sums[n] = insideCells(samples, 8);
        }
    });
    double voxels = 0;
    for (const double sum : sums) voxels += sum;
    if (picked.size() < leaves.leafCount() && !picked.empty())
        voxels *= static_cast<double>(leaves.leafCount()) / static_cast<double>(picked.size());
    // A tile is farther than the band from the surface: no cell that begins in one is mixed.
    auto tile = grid.tree().cbeginValueOff();
    tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile < 0) voxels += static_cast<double>(tile.getVoxelCount());
    return voxels * grid.transform().voxelVolume();
}

}  // namespace stratum::voxelize
