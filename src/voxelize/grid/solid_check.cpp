#include "voxelize/grid/solid_check.h"

#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <bit>
#include <cmath>
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

namespace {

double insideLength(double low, double high) {
    if ((low < 0) == (high < 0)) return low < 0 ? 1 : 0;
    return low < 0 ? low / (low - high) : high / (high - low);
}

// Share of a cell that is inside: the field is linear along z, so exact on each of the four lines of a Gauss rule.
double insideShare(const LeafSamples& leaf, int x, int y, int z) {
    const auto& s = leaf.v;
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

}  // namespace

double insideCells(const LeafSamples& leaf, int edge) {
    const auto& s = leaf.v;
    // One bit for each sample: full and empty cells are found eight at a time.
    std::uint32_t negative[LeafSamples::kEdge][LeafSamples::kEdge];
    for (int x = 0; x < LeafSamples::kEdge; ++x)
        for (int y = 0; y < LeafSamples::kEdge; ++y) {
            std::uint32_t bits = 0;
            for (int z = 0; z < LeafSamples::kEdge; ++z) bits |= (s[x][y][z] < 0 ? 1U : 0U) << z;
            negative[x][y] = bits;
        }
    double sum = 0;
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y) {
            const std::uint32_t all = negative[x][y] & negative[x][y + 1] & negative[x + 1][y] & negative[x + 1][y + 1];
            const std::uint32_t any = negative[x][y] | negative[x][y + 1] | negative[x + 1][y] | negative[x + 1][y + 1];
            const std::uint32_t solid = all & all >> 1 & 0xffU;
            sum += std::popcount(solid);
            for (std::uint32_t mixed = (any | any >> 1) & ~solid & 0xffU; mixed != 0; mixed &= mixed - 1)
                sum += insideShare(leaf, x, y, std::countr_zero(mixed));
        }
    return sum;
}

std::uint64_t scattered(std::uint64_t n) {
    n = (n + 1) * 0x9e3779b97f4a7c15U;
    n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9U;
    n = (n ^ n >> 27) * 0x94d049bb133111ebU;
    return n ^ n >> 31;
}

namespace {

constexpr std::size_t kPlaces = 16;
constexpr std::size_t kInARow = 32;

struct Point {
    double x, y, z;
};

// The point halfway along a bead's center line.
Point middleOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    const double z = 0.5 * (bead.z0 + bead.z1) - sectionOf(toolpath, bead).drop;
    const gcode::PlanPath path(toolpath, bead);
    const gcode::PlanPoint place = path.at(0.5 * path.length());
    return {place.x, place.y, z};
}

struct Nearby {
    BeadField field;
    Bounds box;  // of the solid
};

bool within(const Bounds& box, const Point& p, double reach) {
    return p.x > box.min[0] - reach && p.x < box.max[0] + reach && p.y > box.min[1] - reach &&
           p.y < box.max[1] + reach && p.z > box.min[2] - reach && p.z < box.max[2] + reach;
}

// Trilinear between the eight samples around `p`, of the union of `beads`.
double fieldAt(const std::vector<Nearby>& beads, const Lattice& lattice, const Point& p) {
    const double h = lattice.voxel_size;
    const double at[3] = {p.x / h, p.y / h, (p.z - lattice.origin_z) / h};
    std::vector<const BeadField*> close;
    for (const Nearby& bead : beads)
        if (within(bead.box, p, 3 * h)) close.push_back(&bead.field);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        double sample[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double floor = std::floor(at[axis]);
            const int step = corner >> axis & 1;
            weight *= step != 0 ? at[axis] - floor : 1 - (at[axis] - floor);
            sample[axis] = (floor + step) * h;
        }
        double least = lattice.background();
        for (const BeadField* field : close)
            least = std::min(least, field->distance(sample[0], sample[1], sample[2] + lattice.origin_z));
        sum += weight * least;
    }
    return sum;
}

}  // namespace

double lostShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice) {
    const std::size_t places = std::min(kPlaces, selection.size());
    const double reach = 3 * lattice.voxel_size;
    std::size_t asked = 0;
    std::size_t lost = 0;
    for (std::size_t place = 0; place < places; ++place) {
        const std::size_t first = selection.size() * place / places;
        const std::size_t next = selection.size() * (place + 1) / places;
        const std::size_t count = std::min(kInARow, next - first);
        const std::span<const std::uint32_t> sample = selection.subspan(first + (next - first - count) / 2, count);
        Bounds around = boundsOf(toolpath, sample);
        for (int axis = 0; axis < 3; ++axis) around.min[axis] -= reach, around.max[axis] += reach;
        std::vector<Nearby> near;
        for (const std::uint32_t index : selection) {
            const gcode::Bead& bead = toolpath.beads[index];
            // Filters by height first, without evaluating fields, with a margin of half a bead's width above and below.
            const double margin = static_cast<double>(toolpath.runOf(bead).height) + static_cast<double>(bead.width);
            if (std::max<double>(bead.z0, bead.z1) + margin < around.min[2] ||
                std::min<double>(bead.z0, bead.z1) - margin > around.max[2])
                continue;
            const BeadField field(toolpath, bead);
            const Bounds box = field.bounds();
            bool meets = true;
            for (int axis = 0; axis < 3; ++axis)
                meets = meets && box.min[axis] <= around.max[axis] && box.max[axis] >= around.min[axis];
            if (meets) near.push_back({field, box});
        }
        for (const std::uint32_t index : sample) {
            ++asked;
            lost += fieldAt(near, lattice, middleOf(toolpath, toolpath.beads[index])) >= 0 ? 1 : 0;
        }
    }
    return asked > 0 ? static_cast<double>(lost) / static_cast<double>(asked) : 0;
}

double depositedVolume(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    double sum = 0;
    for (const std::uint32_t index : selection) sum += gcode::laidVolume(toolpath, index);
    return sum;
}

}  // namespace stratum::voxelize
