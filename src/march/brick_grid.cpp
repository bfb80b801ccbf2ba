#include "march/brick_grid.h"

#include "io/error.h"
#include "parallel/parallel_for.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::march {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::FloatGrid::ConstAccessor;
constexpr int kEdge = BrickGrid::kBrickEdge;
constexpr int kSamples = BrickGrid::kSamples;

// The samples of a leaf and of the first planes of its neighbours in +x, +y and +z.
void gather(const Leaf& leaf, Accessor& accessor, BrickGrid::Samples& out) {
    for (int part = 0; part < 8; ++part) {
        const int px = part >> 2;
        const int py = part >> 1 & 1;
        const int pz = part & 1;
        const openvdb::Coord origin = leaf.origin().offsetBy(px * kEdge, py * kEdge, pz * kEdge);
        const Leaf* source = part == 0 ? &leaf : accessor.probeConstLeaf(origin);
        const float tile = source == nullptr ? accessor.getValue(origin) : 0.0F;
        for (int x = px * kEdge; x < (px != 0 ? kSamples : kEdge); ++x)
            for (int y = py * kEdge; y < (py != 0 ? kSamples : kEdge); ++y) {
                const int z0 = pz * kEdge;
                float* row = out.data() + x * BrickGrid::kStrideX + y * BrickGrid::kStrideY + z0;
                const float* values =
                    source == nullptr ? nullptr : source->buffer().data() + ((x & 7) << 6 | (y & 7) << 3);
                // Lengths known to the compiler: a call to copy 32 bytes costs more than the copy.
                if (pz != 0)
                    *row = values == nullptr ? tile : *values;
                else if (values == nullptr)
                    std::fill_n(row, kEdge, tile);
                else
                    std::copy_n(values, kEdge, row);
            }
    }
}

// A bit for every cell whose corners are not of one sign: inside is below zero, zero is outside.
BrickGrid::Surface findSurface(const BrickGrid::Samples& samples) {
    // Bit z of inside[x][y]: sample (x, y, z) is inside.
    std::array<std::array<std::uint32_t, kSamples>, kSamples> inside{};
    const float* value = samples.data();
    for (auto& plane : inside)
        for (std::uint32_t& row : plane)
            for (int z = 0; z < kSamples; ++z) row |= static_cast<std::uint32_t>(*value++ < 0) << z;
    BrickGrid::Surface surface{};
    for (int x = 0; x < kEdge; ++x)
        for (int y = 0; y < kEdge; ++y) {
            const std::size_t sx = static_cast<std::size_t>(x);
            const std::size_t sy = static_cast<std::size_t>(y);
            const std::uint32_t rows[4] = {inside[sx][sy], inside[sx][sy + 1], inside[sx + 1][sy],
                                           inside[sx + 1][sy + 1]};
            const std::uint32_t any = rows[0] | rows[1] | rows[2] | rows[3];
            const std::uint32_t all = rows[0] & rows[1] & rows[2] & rows[3];
            const std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & 0xff;
            for (int half = 0; half < 2; ++half) {
                const std::uint64_t bits = mixed >> (4 * half) & 0xf;
                surface[static_cast<std::size_t>((x >> 2) << 2 | (y >> 2) << 1 | half)] |=
                    bits << Mask64::bit(x & 3, y & 3, 0);
            }
        }
    return surface;
}

bool isEmpty(const BrickGrid::Surface& surface) {
    std::uint64_t any = 0;
    for (const std::uint64_t word : surface) any |= word;
    return any == 0;
}

}  // namespace

BrickGrid::BrickGrid(const openvdb::FloatGrid& grid) {
    std::vector<const Leaf*> leaves;
    leaves.reserve(grid.tree().leafCount());
    grid.tree().getNodes(leaves);
    openvdb::CoordBBox box;
    for (const Leaf* leaf : leaves) box.expand(leaf->getNodeBoundingBox());
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        origin_[axis] = box.min()[axis] & ~(kMacroEdge - 1);
        macros_[a] = (box.max()[axis] - origin_[axis]) / kMacroEdge + 1;
        size_[a] = macros_[a] * kMacroEdge;
        cells *= macros_[a];
    }
    if (cells > 2147483648.0)
        throw InputError(
            fmt::format("the level set spans {} x {} x {} voxels, too far apart to lay out for rays; split "
                        "it or use --march vdb",
                        size_[0], size_[1], size_[2]));
    macro_cells_ = HugeArray<MacroCell>(static_cast<std::size_t>(cells));
    std::fill(macro_cells_.begin(), macro_cells_.end(), MacroCell{});

    // First the masks, which tell what is kept; then the samples of that alone.
    std::vector<Surface> masks(leaves.size());
    constexpr std::size_t kGrain = 256;
    parallelFor(leaves.size(), kGrain, [&](std::size_t first, std::size_t last) {
        Accessor accessor = grid.getConstAccessor();
        Samples samples;
        for (std::size_t n = first; n != last; ++n) {
            gather(*leaves[n], accessor, samples);
            bool finite = true;
            for (const float value : samples) finite &= std::abs(value) <= std::numeric_limits<float>::max();
            if (!finite) {
                const openvdb::Coord at = leaves[n]->origin();
                throw InputError(
                    fmt::format("the level set {} has a voxel that is not a finite number, in or beside the 8 x 8 x 8 "
                                "voxels from index ({}, {}, {}); make the grid again",
                                grid.getName(), at[0], at[1], at[2]));
            }
            masks[n] = findSurface(samples);
        }
    });
    const auto macroOf = [this](const openvdb::Coord& brick) -> MacroCell& {
        return macro_cells_[(static_cast<std::size_t>(brick[0] / kMacroEdge) * static_cast<std::size_t>(macros_[1]) +
                             static_cast<std::size_t>(brick[1] / kMacroEdge)) *
                                static_cast<std::size_t>(macros_[2]) +
                            static_cast<std::size_t>(brick[2] / kMacroEdge)];
    };
    const auto within = [](int cell) { return cell / kBrickEdge & 3; };
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        if (isEmpty(masks[n])) continue;
        const openvdb::Coord at = leaves[n]->origin() - origin_;
        macroOf(at).bricks |= std::uint64_t{1} << Mask64::bit(within(at[0]), within(at[1]), within(at[2]));
    }
    std::uint32_t count = 0;
    for (MacroCell& macro : macro_cells_) {
        macro.first_brick = count;
        count += static_cast<std::uint32_t>(std::popcount(macro.bricks));
    }
    surfaces_ = HugeArray<Surface>(count);
    samples_ = HugeArray<Samples>(count);
    parallelFor(leaves.size(), kGrain, [&](std::size_t first, std::size_t last) {
        Accessor accessor = grid.getConstAccessor();
        for (std::size_t n = first; n != last; ++n) {
            if (isEmpty(masks[n])) continue;
            const openvdb::Coord at = leaves[n]->origin() - origin_;
            const std::size_t brick = brickIndex(macroOf(at), within(at[0]), within(at[1]), within(at[2]));
            surfaces_[brick] = masks[n];
            gather(*leaves[n], accessor, samples_[brick]);
        }
    });
    measureEmptySpace();
}

void BrickGrid::measureEmptySpace() {
    // Chebyshev distance to the nearest occupied macro cell, by a forward and a backward sweep over half of the 26
    // neighbours each (all steps cost one, so two sweeps are exact). Beyond the box everything is empty.
    constexpr std::uint32_t kFar = 1U << 20;
    const int nx = macros_[0];
    const int ny = macros_[1];
    const int nz = macros_[2];
    const auto cell = [&](int x, int y, int z) -> MacroCell& {
        return macro_cells_[(static_cast<std::size_t>(x) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) *
                                static_cast<std::size_t>(nz) +
                            static_cast<std::size_t>(z)];
    };
    for (MacroCell& macro : macro_cells_) macro.empty_radius = macro.bricks != 0 ? 0 : kFar;
    const auto relax = [&](int x, int y, int z, int sign) {
        MacroCell& macro = cell(x, y, z);
        for (int n = 1; n <= 13; ++n) {
            // The 13 neighbours that precede in raster order, or their mirror images.
            const int code = 13 - n;
            const int qx = x + sign * (code / 9 - 1);
            const int qy = y + sign * (code / 3 % 3 - 1);
            const int qz = z + sign * (code % 3 - 1);
            if (qx < 0 || qy < 0 || qz < 0 || qx >= nx || qy >= ny || qz >= nz) continue;
            macro.empty_radius = std::min(macro.empty_radius, cell(qx, qy, qz).empty_radius + 1);
        }
    };
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z) relax(x, y, z, 1);
    for (int x = nx - 1; x >= 0; --x)
        for (int y = ny - 1; y >= 0; --y)
            for (int z = nz - 1; z >= 0; --z) relax(x, y, z, -1);
    // A box that reaches beyond all edges is as good as one that reaches far beyond; small numbers keep products small.
    const auto widest = static_cast<std::uint32_t>(std::max({nx, ny, nz}));
    for (MacroCell& macro : macro_cells_) macro.empty_radius = std::min(macro.empty_radius, widest);
}

std::size_t BrickGrid::bytes() const { return macro_cells_.bytes() + surfaces_.bytes() + samples_.bytes(); }

}  // namespace stratum::march
