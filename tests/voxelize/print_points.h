// What the tests on real prints share: the level beads of a selection alone, and active voxels drawn at random.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace stratum::test {

/// A copy that holds the selected level beads only: what brute force can answer.
inline gcode::Toolpath levelPart(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& selection) {
    gcode::Toolpath part;
    part.runs = toolpath.runs;
    part.arcs = toolpath.arcs;
    part.deposit = toolpath.deposit;
    part.layer_count = toolpath.layer_count;
    for (const std::uint32_t index : selection) {
        if (toolpath.beads[index].z0 != toolpath.beads[index].z1) continue;
        part.beads.push_back(toolpath.beads[index]);
        if (!toolpath.flow.empty()) part.flow.push_back(toolpath.flow[index]);
    }
    return part;
}

/// `count` active voxels of leaves, the same for every run.
inline std::vector<openvdb::Coord> randomActiveVoxels(const openvdb::FloatGrid& grid, std::size_t count) {
    std::vector<const openvdb::FloatTree::LeafNodeType*> leaves;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) leaves.push_back(leaf.getLeaf());
    std::vector<openvdb::Coord> points;
    std::mt19937_64 random(11);
    while (points.size() < count) {
        const auto* leaf = leaves[random() % leaves.size()];
        const auto offset = static_cast<openvdb::Index>(random() % 512);
        if (leaf->isValueOn(offset)) points.push_back(leaf->offsetToGlobalCoord(offset));
    }
    return points;
}

}  // namespace stratum::test
