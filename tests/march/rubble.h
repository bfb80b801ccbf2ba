// Level sets that are hard on rays: creases, thin gaps, near-tangent walls, several crossings in a cell.
#pragma once

#include "spheres.h"

#include <openvdb/tools/Composite.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::test {

/// Many balls within +-4 of the origin that overlap and almost touch, a few voxels across. If `rough`, values are
/// shaken so that cells have several crossings.
inline openvdb::FloatGrid::Ptr rubble(float voxel, bool rough) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> where(-3, 3);
    std::uniform_real_distribution<float> size(0.5F, 1.2F);
    auto all = sphereGrid(1, openvdb::Vec3f(0), voxel);
    for (int n = 0; n < 25; ++n) {
        const openvdb::Vec3f center(where(random), where(random), where(random));
        auto ball = sphereGrid(size(random), center, voxel);
        openvdb::tools::csgUnion(*all, *ball);
    }
    if (rough) {
        std::uniform_real_distribution<float> noise(-0.7F * voxel, 0.7F * voxel);
        for (auto it = all->beginValueOn(); it; ++it)
            if (std::abs(*it) < 1.5F * voxel) it.setValue(*it + noise(random));
    }
    all->setName("surface");
    return all;
}

/// The grid with its samples as bricks of 16 bits hold them.
inline openvdb::FloatGrid::Ptr quantized(const openvdb::FloatGrid& grid) {
    const auto copy = grid.deepCopy();
    const double quantum = static_cast<double>(grid.background()) / 32767;
    const auto round = [quantum](float value) {
        const double n = std::nearbyint(std::clamp(static_cast<double>(value) / quantum, -32767.0, 32767.0));
        return static_cast<float>((value < 0 ? std::min(n, -1.0 / 1024) : n) * quantum);
    };
    for (auto it = copy->beginValueAll(); it; ++it) it.setValue(round(*it));
    return copy;
}

}  // namespace stratum::test
