#include "voxelize/enclosed_volume.h"

#include "parallel/parallel_for.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace stratum::voxelize {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int kEdge = 9;  // a leaf's samples and the next ones in x, y and z
using Samples = float[kEdge][kEdge][kEdge];

void gather(const Leaf& leaf, openvdb::tree::ValueAccessor<const openvdb::FloatTree>& tree, Samples& samples) {
    const float* values = leaf.buffer().data();
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y, values += 8) std::copy_n(values, 8, samples[x][y]);
    for (int corner = 1; corner < 8; ++corner) {
        const openvdb::Coord step(corner & 1, corner >> 1 & 1, corner >> 2);
        const openvdb::Coord origin = leaf.origin() + openvdb::Coord(8 * step[0], 8 * step[1], 8 * step[2]);
        const Leaf* next = tree.probeConstLeaf(origin);
        const float all = next == nullptr ? tree.getValue(origin) : 0.0F;
        for (int x = 0; x < (step[0] != 0 ? 1 : 8); ++x)
            for (int y = 0; y < (step[1] != 0 ? 1 : 8); ++y)
                for (int z = 0; z < (step[2] != 0 ? 1 : 8); ++z)
                    samples[x + 8 * step[0]][y + 8 * step[1]][z + 8 * step[2]] =
                        next != nullptr ? next->buffer().data()[(x * 8 + y) * 8 + z] : all;
    }
}

double insideLength(double low, double high) {
    if ((low < 0) == (high < 0)) return low < 0 ? 1 : 0;
    return low < 0 ? low / (low - high) : high / (high - low);
}

// Share of a cell that is inside: the field is linear along z, so exact on each of the four lines of a Gauss rule.
double insideShare(const Samples& s, int x, int y, int z) {
    constexpr double kGauss[2] = {0.21132486540518713, 0.78867513459481287};
    double sum = 0;
    for (const double u : kGauss)
        for (const double v : kGauss) {
            const auto at = [&](int k) {
                const double a = s[x][y][k] + u * (static_cast<double>(s[x + 1][y][k]) - s[x][y][k]);
                const double b = s[x][y + 1][k] + u * (static_cast<double>(s[x + 1][y + 1][k]) - s[x][y + 1][k]);
                return a + v * (b - a);
            };
            sum += insideLength(at(z), at(z + 1));
        }
    return 0.25 * sum;
}

double insideCells(const Samples& s) {
    double sum = 0;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) {
                int inside = 0;
                for (int n = 0; n < 8; ++n) inside += s[x + (n & 1)][y + (n >> 1 & 1)][z + (n >> 2)] < 0 ? 1 : 0;
                if (inside != 0) sum += inside == 8 ? 1 : insideShare(s, x, y, z);
            }
    return sum;
}

}  // namespace

double enclosedVolume(const openvdb::FloatGrid& grid) {
    const openvdb::tree::LeafManager<const openvdb::FloatTree> leaves(grid.tree());
    // One sum a leaf, added in order: the same value for any number of threads.
    std::vector<double> sums(leaves.leafCount());
    parallelFor(sums.size(), 64, [&](std::size_t first, std::size_t last) {
        openvdb::tree::ValueAccessor<const openvdb::FloatTree> tree(grid.tree());
        Samples samples;
        for (std::size_t n = first; n != last; ++n) {
            gather(leaves.leaf(n), tree, samples);
            sums[n] = insideCells(samples);
        }
    });
    double voxels = 0;
    for (const double sum : sums) voxels += sum;
    // A tile is farther than the band from the surface: no cell that begins in one is mixed.
    for (auto tile = grid.tree().cbeginValueOff(); tile; ++tile)
        if (tile.getLevel() > 0 && *tile < 0) voxels += static_cast<double>(tile.getVoxelCount());
    return voxels * grid.transform().voxelVolume();
}

}  // namespace stratum::voxelize
