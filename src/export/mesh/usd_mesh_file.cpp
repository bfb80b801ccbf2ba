#include "export/mesh/mesh_formats.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "export/mesh/face_groups.h"

#include <fmt/format.h>

#include <limits>

namespace stratum::exporter {
namespace {

// A list "[a, b]" in pieces.
class UsdList {
public:
    explicit UsdList(FileWriter& out) : out_(out) { out_.text("["); }
    void add(const std::string& item) {
        if (!first_) out_.text(", ");
        first_ = false;
        out_.text(item);
    }
    void end() { out_.text("]\n"); }

private:
    FileWriter& out_;
    bool first_ = true;
};

std::string textOf(const openvdb::Vec3s& p) { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

std::string binding(const std::string& material) {
    return fmt::format("rel material:binding = </print/materials/{}>\n", material);
}

constexpr const char* kBindingApi = "prepend apiSchemas = [\"MaterialBindingAPI\"]";

void writeUsdPoints(const SurfaceMesh& mesh, FileWriter& out) {
    openvdb::BBoxd box;
    for (const openvdb::Vec3s& point : mesh.points) box.expand(openvdb::Vec3d(point));
    const openvdb::Vec3s low(mesh.points.empty() ? openvdb::Vec3d(0) : box.min());
    const openvdb::Vec3s high(mesh.points.empty() ? openvdb::Vec3d(0) : box.max());
    out.text(fmt::format("        float3[] extent = [{}, {}]\n        point3f[] points = ", textOf(low), textOf(high)));
    UsdList points(out);
    for (const openvdb::Vec3s& point : mesh.points) points.add(textOf(point));
    points.end();
}

void writeUsdFaces(const SurfaceMesh& mesh, FileWriter& out) {
    out.text("        int[] faceVertexCounts = ");
    UsdList counts(out);
    for (const SurfaceMesh::Face& face : mesh.faces) counts.add(face[3] == SurfaceMesh::kNone ? "3" : "4");
    counts.end();
    out.text("        int[] faceVertexIndices = ");
    UsdList indices(out);
    for (const SurfaceMesh::Face& face : mesh.faces)
        for (const std::uint32_t corner : face)
            if (corner != SurfaceMesh::kNone) indices.add(std::to_string(corner));
    indices.end();
}

void writeSubsets(const SurfaceMesh& mesh, FileWriter& out) {
    for (std::size_t group = 0; group < mesh.materials.size(); ++group) {
        const std::string& name = mesh.materials[group].name;
        out.text(
            fmt::format("\n        def GeomSubset \"{}\" (\n            {}\n        )\n        {{\n"
                        "            uniform token elementType = \"face\"\n"
                        "            uniform token familyName = \"materialBind\"\n            int[] indices = ",
                        name, kBindingApi));
        UsdList indices(out);
        for (std::size_t n = 0; n < mesh.faces.size(); ++n)
            if (mesh.materialOf(mesh.faces[n]) == group) indices.add(std::to_string(n));
        indices.end();
        out.text("            " + binding(name) + "        }\n");
    }
}

}  // namespace

std::string usdMaterials(std::span<const MeshMaterial> materials, const std::string& parent) {
    if (materials.empty()) return {};
    std::string text = "\n    def Scope \"materials\"\n    {\n";
    for (const MeshMaterial& material : materials) {
        const auto linear = linearOf(material.color);
        text += fmt::format(
            "        def Material \"{0}\"\n        {{\n"
            "            token outputs:surface.connect = <{1}/materials/{0}/surface.outputs:surface>\n\n"
            "            def Shader \"surface\"\n            {{\n"
            "                uniform token info:id = \"UsdPreviewSurface\"\n"
            "                color3f inputs:diffuseColor = ({2:.6f}, {3:.6f}, {4:.6f})\n"
            "                float inputs:metallic = 0\n                float inputs:roughness = {5}\n"
            "                token outputs:surface\n            }}\n        }}\n",
            material.name, parent, linear[0], linear[1], linear[2], kPlasticRoughness);
    }
    return text + "    }\n";
}

void writeUsdMesh(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
    const std::size_t corners = 2 * mesh.faces.size() + mesh.triangleCount();
    if (corners > kMost || mesh.points.size() > kMost)
        throw UsageError(fmt::format("{}: {} corners of faces are more than USD can count; choose a larger voxel",
                                     path.string(), corners));
    FileWriter out(path);
    const bool one = mesh.materials.size() == 1;
    out.text(fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"print\"\n    doc = \"by Stratum {}\"\n    metersPerUnit = {}\n"
        "    upAxis = \"{}\"\n)\n\ndef Xform \"print\" (\n    kind = \"component\"\n)\n{{\n    def Mesh \"surface\"{}\n"
        "    {{\n        uniform token subdivisionScheme = \"none\"\n        uniform token orientation = "
        "\"rightHanded\"\n",
        STRATUM_VERSION, 1e-3 * space.mm_per_unit, space.up_y ? "Y" : "Z",
        one ? fmt::format(" (\n        {}\n    )", kBindingApi) : ""));
    writeUsdPoints(mesh, out);
    writeUsdFaces(mesh, out);
    if (one) out.text("        " + binding(mesh.materials.front().name));
    if (!mesh.material_of_point.empty() && !one) {
        out.text("        uniform token subsetFamily:materialBind:familyType = \"partition\"\n");
        writeSubsets(mesh, out);
    }
    out.text("    }\n" + usdMaterials(mesh.materials, "/print") + "}\n");
    out.commit();
}

}  // namespace stratum::exporter
