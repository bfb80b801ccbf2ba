#include "study/print.h"

#include "base/error.h"
#include "corpus.h"
#include "voxelize/beads/selection.h"

#include <gtest/gtest.h>

namespace stratum::study {
namespace {

TEST(Print, IsReadAndLaidOnALattice) {
    const std::string path = (test::dataDir() / "gcode" / "tile.gcode").string();
    const gcode::Toolpath toolpath = readPrint(path);
    const auto beads = voxelize::selectBeads(toolpath, {});
    EXPECT_DOUBLE_EQ(latticeOf(toolpath, beads, 0.1).voxel_size, 0.1);
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, 4);
    EXPECT_NEAR(lattice.voxel_size, lattice.layer_height / 4, 1e-12);
    EXPECT_EQ(shortHash(path).size(), 12U);
    EXPECT_NE(shortHash(path), shortHash((test::dataDir() / "gcode" / "hull.gcode").string()));
    EXPECT_THROW(shortHash("no such file"), InputError);
}

}  // namespace
}  // namespace stratum::study
