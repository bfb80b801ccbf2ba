#include "export/mesh/mesh_formats.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "export/mesh/face_groups.h"
#include "gcode/toolpath/color.h"

#include <fmt/format.h>

#include <optional>

namespace stratum::exporter {
namespace {

void writeMtl(const SurfaceMesh& mesh, FileWriter& out) {
    out.text(fmt::format("# by Stratum {}\n", STRATUM_VERSION));
    for (const MeshMaterial& material : mesh.materials) {
        const auto linear = linearOf(material.color);
        out.text(fmt::format("\nnewmtl {}\n# sRGB {}\nKd {:.6f} {:.6f} {:.6f}\nKs 0.04 0.04 0.04\nNs 40\nillum 2\n",
                             material.name, gcode::colorText(material.color), linear[0], linear[1], linear[2]));
    }
    out.close();
}

void writeFaces(const SurfaceMesh& mesh, FileWriter& out) {
    const FaceGroups groups(mesh);
    for (std::size_t group = 0; group < groups.count(); ++group) {
        if (groups.faces(group) == 0) continue;
        if (!mesh.materials.empty()) out.text(fmt::format("usemtl {}\n", mesh.materials[group].name));
        // Counted from 1.
        groups.forEachFace(mesh, group, [&out](const SurfaceMesh::Face& face) {
            out.text(fmt::format("f {} {} {}", face[0] + 1, face[1] + 1, face[2] + 1));
            out.text(face[3] != SurfaceMesh::kNone ? fmt::format(" {}\n", face[3] + 1) : "\n");
        });
    }
}

}  // namespace

std::filesystem::path mtlOf(std::filesystem::path obj) { return obj.replace_extension(".mtl"); }

void writeObj(const SurfaceMesh& mesh, const std::filesystem::path& path) {
    const bool materials = !mesh.materials.empty();
    if (materials && isStandardOutput(path))
        throw UsageError(fmt::format("-o {}: colours of an OBJ are in a .mtl beside it; name a file", path.string()));
    FileWriter out(path);
    std::optional<FileWriter> mtl;
    if (materials) writeMtl(mesh, mtl.emplace(mtlOf(path)));
    out.text(fmt::format("# by Stratum {}\n", STRATUM_VERSION));
    if (materials) out.text(fmt::format("mtllib {}\n", mtlOf(path).filename().string()));
    for (const openvdb::Vec3s& p : mesh.points) out.text(fmt::format("v {} {} {}\n", p[0], p[1], p[2]));
    writeFaces(mesh, out);
    out.close();  // both are whole before one has its name
    if (mtl) mtl->commit();
    out.commit();
}

}  // namespace stratum::exporter
