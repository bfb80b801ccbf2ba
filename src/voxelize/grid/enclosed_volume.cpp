#include "voxelize/grid/enclosed_volume.h"

#include "base/parallel_for.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
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
    // One bit for each sample: full and empty cells are found eight at a time.
    std::uint32_t negative[kEdge][kEdge];
    for (int x = 0; x < kEdge; ++x)
        for (int y = 0; y < kEdge; ++y) {
            std::uint32_t bits = 0;
            for (int z = 0; z < kEdge; ++z) bits |= (s[x][y][z] < 0 ? 1U : 0U) << z;
            negative[x][y] = bits;
        }
    double sum = 0;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            const std::uint32_t all = negative[x][y] & negative[x][y + 1] & negative[x + 1][y] & negative[x + 1][y + 1];
            const std::uint32_t any = negative[x][y] | negative[x][y + 1] | negative[x + 1][y] | negative[x + 1][y + 1];
            const std::uint32_t solid = all & all >> 1 & 0xffU;
            sum += std::popcount(solid);
            for (std::uint32_t mixed = (any | any >> 1) & ~solid & 0xffU; mixed != 0; mixed &= mixed - 1)
                sum += insideShare(s, x, y, std::countr_zero(mixed));
        }
    return sum;
}

// A hash (splitmix64's last step), because leaves are in a regular order and every n-th would be a biased sample.
std::uint64_t scattered(std::uint64_t n) {
    n = (n + 1) * 0x9e3779b97f4a7c15U;
    n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9U;
    n = (n ^ n >> 27) * 0x94d049bb133111ebU;
    return n ^ n >> 31;
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
        Samples samples;
        for (std::size_t n = first; n != last; ++n) {
            gather(leaves.leaf(picked[n]), tree, samples);
            sums[n] = insideCells(samples);
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
