#include "voxelize/grid/interior_distance.h"

#include "base/parallel_for.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>

namespace stratum::voxelize {

void sweepInterior(openvdb::FloatGrid& grid) {
    const float background = grid.background();
    const openvdb::FloatGrid::Ptr swept = openvdb::tools::sdfToSdf(grid);
    const openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
    parallelFor(leaves.leafCount(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) {
            auto& leaf = leaves.leaf(n);
            const auto* other = swept->tree().probeConstLeaf(leaf.origin());
            if (other == nullptr) continue;
            for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
                if (*voxel >= 0) continue;
                const float value = other->getValue(voxel.pos());
                // The sweep must not change signs: a zero crossing that rounds to the other side keeps its sign.
                voxel.setValue(value < 0 ? std::max(value, -background) : *voxel);
                if (*voxel <= -background) voxel.setValueOff();
            }
        }
    });
    openvdb::tools::pruneLevelSet(grid.tree());
}

}  // namespace stratum::voxelize
