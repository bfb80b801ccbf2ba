// Embree's part in `vdbstudy polygons`.
#include "study/polygons/peer_tracers.h"

#include "embree_intersector.h"

namespace stratum::study {

PeerTracers peerTracers() {
    using bench::embreeIntersector;
    PeerTracers peers;
    peers.mesh = [](const TriangleMesh& mesh) {
        std::vector<bench::Corner> corners;
        for (const glm::dvec3& p : mesh.corners)
            corners.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
        std::vector<bench::Triangle> triangles;
        for (const glm::uvec3& t : mesh.triangles) triangles.push_back({{t.x, t.y, t.z}});
        return Traced{embreeIntersector(bench::triangleScene(corners, triangles), mesh.objects), triangles.size()};
    };
    peers.beads = [](const gcode::Toolpath& toolpath, int corners, double split) {
        auto scene = corners == 0 ? bench::beadScene(toolpath, split) : bench::prismScene(toolpath, corners, split);
        const std::size_t primitives = scene->primitives();
        return Traced{embreeIntersector(std::move(scene)), primitives};
    };
    return peers;
}

}  // namespace stratum::study
