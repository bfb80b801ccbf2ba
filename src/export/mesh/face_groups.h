// The faces of a mesh, ordered by their materials.
#pragma once

#include "export/mesh/surface_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::exporter {

class FaceGroups {
public:
    /// Takes 4 bytes a face, if the mesh has several materials.
    explicit FaceGroups(const SurfaceMesh& mesh);

    /// As many as materials; one if there are none. A group may be empty.
    std::size_t count() const { return begin_.size() - 1; }
    std::size_t faces(std::size_t group) const { return begin_[group + 1] - begin_[group]; }
    std::size_t triangles(std::size_t group) const { return triangles_[group]; }

    /// Calls visit(face) with each face of a group, in the order of the mesh.
    template <typename Visit>
    void forEachFace(const SurfaceMesh& mesh, std::size_t group, const Visit& visit) const {
        for (std::size_t n = begin_[group]; n < begin_[group + 1]; ++n)
            visit(mesh.faces[order_.empty() ? n : order_[n]]);
    }
    /// Calls visit(a, b, c) with the points of each triangle of a group; a quad has two.
    template <typename Visit>
    void forEachTriangle(const SurfaceMesh& mesh, std::size_t group, const Visit& visit) const {
        forEachFace(mesh, group, [&](const SurfaceMesh::Face& f) {
            visit(f[0], f[1], f[2]);
            if (f[3] != SurfaceMesh::kNone) visit(f[0], f[2], f[3]);
        });
    }

private:
    std::vector<std::uint32_t> order_;  // indices of faces; empty: as they are
    std::vector<std::size_t> begin_;    // by group, and the end
    std::vector<std::size_t> triangles_;
};

}  // namespace stratum::exporter
