#include "voxelize/grid/interior_distance.h"

#include "base/parallel_for.h"
#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stop_token>
#include <thread>

namespace stratum::voxelize {
namespace {

// A solid block of beads.
openvdb::FloatGrid::Ptr block() {
    gcode::Toolpath toolpath;
    for (std::uint32_t layer = 1; layer <= 20; ++layer)
        for (int line = 0; line < 20; ++line)
            test::addBead(toolpath, 0, 0.4 * line, 0.2 * layer, 8, 0.4 * line, 0.2 * layer, 0.45, 0.2, layer);
    Lattice lattice;
    lattice.voxel_size = 0.04;
    lattice.half_width = 3;
    return voxelize(toolpath, test::allBeads(toolpath), lattice);
}

// Every moment of the sweep's own preparations and loops is one at which it may be asked to stop.
TEST(InteriorDistance, StopsAtAnyMoment) {
    const openvdb::FloatGrid::Ptr grid = block();
    int stopped = 0;
    for (int n = 0; n < 60; ++n) {
        const openvdb::FloatGrid::Ptr copy = grid->deepCopy();
        std::stop_source source;
        const std::stop_token token = source.get_token();
        const std::jthread asks([&source, n] {
            std::this_thread::sleep_for(std::chrono::microseconds(700 * n));
            source.request_stop();
        });
        const StopScope scope(&token);
        try {
            sweepInterior(*copy);
        } catch (const Stopped&) {
            ++stopped;
        }
    }
    EXPECT_GT(stopped, 5);
}

}  // namespace
}  // namespace stratum::voxelize
