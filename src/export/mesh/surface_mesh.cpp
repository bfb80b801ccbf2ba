#include "export/mesh/surface_mesh.h"

#include "base/memory.h"
#include "base/parallel_for.h"
#include "base/srgb.h"
#include "base/union_find.h"
#include "export/mesh/mesh_simplify.h"

#include <fmt/format.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

namespace stratum::exporter {
namespace {

constexpr double kClearance = 1e-3;  // voxels

void clearSurface(openvdb::FloatGrid& grid) {
    const auto least = static_cast<float>(kClearance * grid.voxelSize()[0]);
    std::vector<openvdb::FloatTree::LeafNodeType*> leaves;
    grid.tree().getNodes(leaves);
    parallelFor(leaves.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n)
            for (auto value = leaves[n]->beginValueAll(); value; ++value)
                if (*value > -least && *value < least) value.setValue(-least);
    });
}

// Of the tetrahedron between a triangle and a point of the mesh, signed.
double sixfoldVolume(const SurfaceMesh& mesh, std::uint32_t from, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const openvdb::Vec3d origin(mesh.points[from]);
    return (openvdb::Vec3d(mesh.points[a]) - origin)
        .dot((openvdb::Vec3d(mesh.points[b]) - origin).cross(openvdb::Vec3d(mesh.points[c]) - origin));
}

// The face after merging its corners; false if it has no area any more. A face that collapses to a line removes each of
// its edges in both directions, so its neighbours become adjacent.
bool reduce(SurfaceMesh::Face& face) {
    std::array<std::uint32_t, 4> left{};
    std::size_t count = 0;
    const std::size_t corners = face[3] == SurfaceMesh::kNone ? 3 : 4;
    for (std::size_t n = 0; n < corners; ++n)
        if (face[n] != face[(n + 1) % corners]) left[count++] = face[n];
    if (count < 3 || (count == 4 && (left[0] == left[2] || left[1] == left[3]))) return false;
    if (count == 3) left[3] = SurfaceMesh::kNone;
    face = left;
    return true;
}

// The surface of a cavity is a connected part of its own, whose faces are oriented towards the cavity.
void dropCavities(SurfaceMesh& mesh) {
    UnionFind parts(mesh.points.size());
    for (const SurfaceMesh::Face& face : mesh.faces)
        for (const std::uint32_t corner : face)
            if (corner != SurfaceMesh::kNone) parts.join(face[0], corner);
    // Relative to a point of the same part, for the precision of small distant parts.
    std::vector<double> volume(mesh.points.size(), 0.0);
    mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const std::uint32_t part = parts.find(a);
        volume[part] += sixfoldVolume(mesh, part, a, b, c);
    });
    std::erase_if(mesh.faces, [&](const SurfaceMesh::Face& face) { return !(volume[parts.find(face[0])] > 0); });
}

// The remaining points keep their order.
void dropUnusedPoints(SurfaceMesh& mesh) {
    std::vector<std::uint32_t> place(mesh.points.size(), SurfaceMesh::kNone);
    for (const SurfaceMesh::Face& face : mesh.faces)
        for (const std::uint32_t corner : face)
            if (corner != SurfaceMesh::kNone) place[corner] = 0;
    std::uint32_t next = 0;
    for (std::size_t n = 0; n < place.size(); ++n) {
        if (place[n] == SurfaceMesh::kNone) continue;
        mesh.points[next] = mesh.points[n];
        place[n] = next++;
    }
    mesh.points.resize(next);
    for (SurfaceMesh::Face& face : mesh.faces)
        for (std::uint32_t& corner : face)
            if (corner != SurfaceMesh::kNone) corner = place[corner];
}

// A byte of linear light.
std::uint32_t srgb(float linear) {
    return static_cast<std::uint32_t>(
        std::lround(255 * srgbOfLinear(std::clamp(static_cast<double>(linear), 0.0, 1.0))));
}

// 0xTTRRGGBB by point, of the nearest active voxel among the eight around it and those beside them; T is the tool.
std::vector<std::uint32_t> labelsOf(const SurfaceMesh& mesh, const openvdb::Vec3SGrid& grid,
                                    const openvdb::Int32Grid* tools) {
    std::vector<std::uint32_t> labels(mesh.points.size());
    parallelFor(labels.size(), 4096, [&](std::size_t first, std::size_t last) {
        const auto voxels = grid.getConstAccessor();
        std::optional<openvdb::Int32Grid::ConstAccessor> tool_of;
        if (tools != nullptr) tool_of.emplace(tools->getConstAccessor());
        // Cached, because there are few colors and many points.
        openvdb::Vec3f known(-1);
        std::uint32_t packed = 0;
        for (std::size_t n = first; n != last; ++n) {
            const openvdb::Vec3d at = grid.worldToIndex(openvdb::Vec3d(mesh.points[n]));
            const openvdb::Coord middle = openvdb::Coord::round(at);
            double nearest = 1e300;
            openvdb::Vec3f color(0.8F);
            openvdb::Coord of;
            for (int k = 0; k < 27; ++k) {
                const openvdb::Coord voxel = middle.offsetBy(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                const double distance = (voxel.asVec3d() - at).lengthSqr();
                openvdb::Vec3f value;
                if (distance >= nearest || !voxels.probeValue(voxel, value)) continue;
                nearest = distance;
                color = value;
                of = voxel;
            }
            if (color != known) packed = srgb(color[0]) << 16 | srgb(color[1]) << 8 | srgb(color[2]);
            known = color;
            const bool has_tool = tool_of && nearest < 1e300;
            labels[n] = packed | (has_tool ? static_cast<std::uint32_t>(tool_of->getValue(of) & 0xff) << 24 : 0U);
        }
    });
    return labels;
}

// The materials that labels stand for, by ascending labels; and that of each point.
void takeMaterials(const std::vector<std::uint32_t>& labels, bool by_tool, SurfaceMesh& mesh) {
    std::vector<std::uint32_t> all = labels;
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (const std::uint32_t label : all) {
        const std::uint32_t tool = label >> 24;
        const std::uint32_t color = label & 0xffffff;
        const auto of_tool =
            std::count_if(all.begin(), all.end(), [tool](std::uint32_t other) { return other >> 24 == tool; });
        const std::string name = !by_tool      ? fmt::format("color_{:06x}", color)
                                 : of_tool > 1 ? fmt::format("tool_{}_{:06x}", tool, color)
                                               : fmt::format("tool_{}", tool);
        mesh.materials.push_back({name,
                                  {static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 8 & 0xff),
                                   static_cast<std::uint8_t>(color & 0xff)}});
    }
    mesh.material_of_point.reserve(labels.size());
    for (const std::uint32_t label : labels)
        mesh.material_of_point.push_back(
            static_cast<std::uint32_t>(std::lower_bound(all.begin(), all.end(), label) - all.begin()));
}

// By so many voxels.
void simplifyBy(double error, const openvdb::FloatGrid& grid, std::vector<std::uint32_t>& labels, SurfaceMesh& mesh) {
    labels = simplify(mesh, error * grid.voxelSize()[0], labels);
    mesh.error += error;
}

}  // namespace

SurfaceMesh meshSurface(const openvdb::FloatGrid& grid, const MeshOptions& options) {
    requireMemory(kMeshBytesPerLeaf * grid.tree().leafCount(), "a mesh of it",
                  "choose a larger voxel, fewer layers or features, or --interior cull");
    const openvdb::FloatGrid::Ptr copy = grid.deepCopy();
    clearSurface(*copy);
    SurfaceMesh mesh;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*copy, mesh.points, triangles, quads, 0.0, 0.0);
    // Corners come clockwise from outside.
    mesh.faces.reserve(triangles.size() + quads.size());
    for (const openvdb::Vec3I& t : triangles) mesh.faces.push_back({t[2], t[1], t[0], SurfaceMesh::kNone});
    std::vector<openvdb::Vec3I>().swap(triangles);
    for (const openvdb::Vec4I& q : quads) mesh.faces.push_back({q[3], q[2], q[1], q[0]});
    std::vector<openvdb::Vec4I>().swap(quads);

    UnionFind merging(mesh.points.size());
    for (const SurfaceMesh::Face& face : mesh.faces) {
        const std::size_t corners = face[3] == SurfaceMesh::kNone ? 3 : 4;
        for (std::size_t n = 0; n < corners; ++n) {
            const std::uint32_t a = face[n];
            const std::uint32_t b = face[(n + 1) % corners];
            if (mesh.points[a] == mesh.points[b]) merging.join(a, b);
        }
    }
    std::size_t kept = 0;
    for (SurfaceMesh::Face face : mesh.faces) {
        for (std::uint32_t& corner : face)
            if (corner != SurfaceMesh::kNone) corner = merging.find(corner);
        if (reduce(face)) mesh.faces[kept++] = face;
    }
    mesh.faces.resize(kept);

    if (options.outside_only) dropCavities(mesh);
    dropUnusedPoints(mesh);
    std::vector<std::uint32_t> labels;
    if (options.color != nullptr) labels = labelsOf(mesh, *options.color, options.tool);
    if (options.error > 0) simplifyBy(options.error, grid, labels, mesh);
    // A triangle stays where its neighbours are as large: the error grows until there are few enough.
    constexpr double kFirstError = 0.25;
    constexpr double kMostError = 64;
    // No farther than it helps: what is left may be borders of materials, which stay.
    constexpr int kMostIdle = 5;  // steps
    double error = std::max(options.error, kFirstError);
    int idle = 0;
    while (options.most_triangles > 0 && mesh.triangleCount() > options.most_triangles && error <= kMostError &&
           idle < kMostIdle) {
        const std::size_t before = mesh.triangleCount();
        simplifyBy(error, grid, labels, mesh);
        error *= 1.3;
        idle = 100 * mesh.triangleCount() > 99 * before ? idle + 1 : 0;
    }
    if (options.color != nullptr) takeMaterials(labels, options.tool != nullptr, mesh);
    return mesh;
}

std::uint32_t SurfaceMesh::materialOf(const Face& face) const {
    const std::size_t corners = face[3] == kNone ? 3 : 4;
    std::uint32_t most = material_of_point[face[0]];
    std::ptrdiff_t votes = 0;
    for (std::size_t n = 0; n < corners; ++n) {
        const std::uint32_t material = material_of_point[face[n]];
        const auto same = std::count_if(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(corners),
                                        [&](std::uint32_t p) { return material_of_point[p] == material; });
        if (same > votes) most = material;
        votes = std::max(votes, same);
    }
    return most;
}

std::size_t SurfaceMesh::triangleCount() const {
    std::size_t count = faces.size();
    for (const Face& face : faces) count += face[3] != kNone;
    return count;
}

double SurfaceMesh::volume() const {
    if (points.empty()) return 0;
    // Relative to a point of the surface, for precision.
    double six = 0;
    forEachTriangle(
        [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { six += sixfoldVolume(*this, 0, a, b, c); });
    return six / 6;
}

}  // namespace stratum::exporter
