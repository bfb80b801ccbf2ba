// libFuzzer: any bytes as beads in a small box: capsules, settled, with corners and arcs. Their level set has no NaN,
// no value beyond the background, and the same bytes for the same beads.
//
// How to build and run it stands in scripts/fuzz.sh. The first byte chooses the model of the plastic, then ten bytes
// are a bead: x, y, z of both ends, width, height, sweep and a byte of options.
#include "base/error.h"
#include "fuzz/require.h"
#include "study/geometry/handmade.h"
#include "voxelize/grid/voxelizer.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace {

using stratum::gcode::Toolpath;
using stratum::voxelize::Lattice;

constexpr std::size_t kBytes = 10;
constexpr std::size_t kMostBeads = 5000;
constexpr double kSpan = 3;  // mm

double share(std::uint8_t byte) { return byte / 255.0; }

void addBead(std::span<const std::uint8_t, kBytes> in, Toolpath& toolpath) {
    const double height = 0.05 + 0.45 * share(in[7]);
    const double width = height + 1.5 * share(in[6]);
    const double z = 0.5 + kSpan * share(in[2]) + 1e-6 * in[9];
    const double rise = in[9] % 8 == 1 ? 0.4 * share(in[5]) : 0;
    if (in[9] % 8 == 2) {
        stratum::study::addArc(toolpath, kSpan * share(in[0]), kSpan * share(in[1]), 0.05 + share(in[3]),
                               6.28 * share(in[4]), 6.28 * (2 * share(in[8]) - 1), z, z + rise, width, height);
    } else {
        stratum::study::addBead(toolpath, kSpan * share(in[0]), kSpan * share(in[1]), z, kSpan * share(in[3]),
                                kSpan * share(in[4]), z + rise, width, height);
    }
}

Toolpath beadsOf(std::span<const std::uint8_t> bytes) {
    Toolpath toolpath;
    if (bytes.empty()) return toolpath;
    using Beads = stratum::gcode::DepositModel::Beads;
    constexpr Beads kModels[] = {Beads::capsule, Beads::grooves, Beads::settled};
    toolpath.deposit.beads = kModels[bytes[0] % 3];
    toolpath.deposit.corner_fraction = share(bytes[0]);
    for (bytes = bytes.subspan(1); bytes.size() >= kBytes && toolpath.beads.size() < kMostBeads;
         bytes = bytes.subspan(kBytes))
        addBead(bytes.first<kBytes>(), toolpath);
    return toolpath;
}

void check(const openvdb::FloatGrid& grid, const openvdb::FloatGrid& again, float background) {
    require(grid.tree().leafCount() == again.tree().leafCount());
    auto other = again.tree().cbeginLeaf();
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf, ++other) {
        require(leaf->origin() == other->origin());
        const float* const values = leaf->buffer().data();
        require(std::memcmp(values, other->buffer().data(), sizeof(float) * 512) == 0);
        for (std::size_t n = 0; n < 512; ++n) require(values[n] >= -background && values[n] <= background);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Toolpath toolpath = beadsOf({data, size});
    if (toolpath.beads.empty()) return 0;
    Lattice lattice;
    lattice.voxel_size = 0.1;
    lattice.half_width = 3;
    const auto beads = stratum::study::allBeads(toolpath);
    check(*stratum::voxelize::voxelize(toolpath, beads, lattice),
          *stratum::voxelize::voxelize(toolpath, beads, lattice), static_cast<float>(lattice.background()));
    return 0;
}
