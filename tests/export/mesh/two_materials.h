// A small closed mesh of two materials: a pyramid, its bottom and one side of the first.
#pragma once

#include "export/mesh/surface_mesh.h"
#include "scratch_folder.h"

#include <cstdint>

namespace stratum::test {

/// One quad below, four triangles. Points 0, 1 and 2 are of the second material, 3 and 4 of the first.
inline exporter::SurfaceMesh twoMaterials() {
    exporter::SurfaceMesh mesh;
    mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 3}};
    constexpr std::uint32_t none = exporter::SurfaceMesh::kNone;
    mesh.faces = {{3, 2, 1, 0}, {0, 1, 4, none}, {1, 2, 4, none}, {2, 3, 4, none}, {3, 0, 4, none}};
    mesh.materials = {{"tool_0", {255, 128, 0}}, {"tool_1", {0, 0, 255}}};
    mesh.material_of_point = {1, 1, 1, 0, 0};
    return mesh;
}

}  // namespace stratum::test
