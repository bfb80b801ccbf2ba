#include "export/mesh/face_groups.h"

namespace stratum::exporter {

FaceGroups::FaceGroups(const SurfaceMesh& mesh) {
    const bool several = !mesh.material_of_point.empty();
    const std::size_t groups = several ? mesh.materials.size() : 1;
    begin_.assign(groups + 1, 0);
    triangles_.assign(groups, 0);
    for (const SurfaceMesh::Face& face : mesh.faces) {
        const std::size_t group = several ? mesh.materialOf(face) : 0;
        ++begin_[group + 1];
        triangles_[group] += face[3] == SurfaceMesh::kNone ? 1 : 2;
    }
    for (std::size_t n = 0; n < groups; ++n) begin_[n + 1] += begin_[n];
    if (!several) return;
    order_.resize(mesh.faces.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t n = 0; n < mesh.faces.size(); ++n)
        order_[next[mesh.materialOf(mesh.faces[n])]++] = static_cast<std::uint32_t>(n);
}

}  // namespace stratum::exporter
