// Level sets whose hits are known on paper.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

namespace stratum::test {

inline openvdb::FloatGrid::Ptr sphereGrid(float radius, const openvdb::Vec3f& center, float voxel,
                                          float half_width = 3) {
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, center, voxel, half_width);
    grid->setName("surface");
    return grid;
}

}  // namespace stratum::test
