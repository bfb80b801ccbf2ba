#include "export/mesh_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "export/mesh/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace stratum::exporter {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written as the machine holds numbers");

std::string extensionOf(const std::filesystem::path& path) { return lowerCase(path.extension().string()); }

void writeStl(const SurfaceMesh& mesh, FileWriter& out) {
    std::array<char, 80> header{};
    fmt::format_to_n(header.data(), header.size() - 1, "binary STL by Stratum {}", STRATUM_VERSION);
    out.raw(header);
    out.raw(static_cast<std::uint32_t>(mesh.triangleCount()));
    mesh.forEachTriangle([&](std::uint32_t ia, std::uint32_t ib, std::uint32_t ic) {
        const openvdb::Vec3s& a = mesh.points[ia];
        const openvdb::Vec3s& b = mesh.points[ib];
        const openvdb::Vec3s& c = mesh.points[ic];
        openvdb::Vec3s normal = (b - a).cross(c - a);
        // A triangle without area has no normal; with zeros the reader computes its own.
        if (!normal.normalize()) normal = openvdb::Vec3s(0);
        for (const openvdb::Vec3s& v : {normal, a, b, c})
            for (int axis = 0; axis < 3; ++axis) out.raw(v[axis]);
        out.raw(std::uint16_t{0});
    });
}

std::size_t cornersOf(const SurfaceMesh::Face& face) { return face[3] == SurfaceMesh::kNone ? 3 : 4; }

void writePly(const SurfaceMesh& mesh, FileWriter& out) {
    out.text(fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment by Stratum {}\nelement vertex {}\nproperty float x\n"
        "property float y\nproperty float z\n{}element face {}\nproperty list uchar uint vertex_indices\n"
        "end_header\n",
        STRATUM_VERSION, mesh.points.size(),
        mesh.material_of_point.empty() ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n",
        mesh.faces.size()));
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        for (int axis = 0; axis < 3; ++axis) out.raw(mesh.points[n][axis]);
        if (!mesh.material_of_point.empty()) out.raw(mesh.materials[mesh.material_of_point[n]].color);
    }
    for (const SurfaceMesh::Face& face : mesh.faces) {
        out.raw(static_cast<std::uint8_t>(cornersOf(face)));
        for (std::size_t n = 0; n < cornersOf(face); ++n) out.raw(face[n]);
    }
}

void writeBinary(const SurfaceMesh& mesh, const std::filesystem::path& path, bool ply) {
    FileWriter out(path);
    ply ? writePly(mesh, out) : writeStl(mesh, out);
    out.commit();
}

constexpr std::array<std::string_view, 6> kMeshes{".stl", ".ply", ".obj", ".3mf", ".glb", ".usda"};

}  // namespace

bool isMeshPath(const std::filesystem::path& path) {
    return std::find(kMeshes.begin(), kMeshes.end(), extensionOf(path)) != kMeshes.end();
}

MeshColors meshColors(const std::filesystem::path& path) {
    const std::string extension = extensionOf(path);
    if (extension == ".stl" || !isMeshPath(path)) return MeshColors::none;
    if (extension == ".ply") return MeshColors::points;
    return extension == ".obj" ? MeshColors::optional_materials : MeshColors::materials;
}

std::optional<std::filesystem::path> meshCompanion(const std::filesystem::path& path) {
    if (extensionOf(path) != ".obj" || isStandardOutput(path)) return std::nullopt;
    return mtlOf(path);
}

void writeMesh(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space) {
    if (mesh.triangleCount() > std::numeric_limits<std::uint32_t>::max())
        throw UsageError(fmt::format("{}: {} triangles are more than the format can count; choose a larger voxel",
                                     path.string(), mesh.triangleCount()));
    const std::string extension = extensionOf(path);
    if (extension == ".obj")
        writeObj(mesh, path);
    else if (extension == ".3mf")
        write3mf(mesh, path, space);
    else if (extension == ".glb")
        writeGlb(mesh, path, space);
    else if (extension == ".usda")
        writeUsdMesh(mesh, path, space);
    else
        writeBinary(mesh, path, extension == ".ply");
}

}  // namespace stratum::exporter
