#include "export/mesh/mesh_formats.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "export/mesh/face_groups.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>

namespace stratum::exporter {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF is little endian");

// Numbers of the specification.
constexpr std::uint32_t kMagic = 0x46546c67;
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr std::uint64_t kBytesPerItem = 12;  // of three floats, or three indices

std::array<float, 3> placed(const openvdb::Vec3s& point, const MeshSpace& space) {
    const openvdb::Vec3d metres = space.upY(openvdb::Vec3d(point)) * (1e-3 * space.mm_per_unit);
    return {static_cast<float>(metres[0]), static_cast<float>(metres[1]), static_cast<float>(metres[2])};
}

Json materialsOf(const SurfaceMesh& mesh) {
    Json materials = Json::array();
    for (const MeshMaterial& material : mesh.materials) {
        const auto linear = linearOf(material.color);
        materials.push_back({{"name", material.name},
                             {"pbrMetallicRoughness",
                              {{"baseColorFactor", {linear[0], linear[1], linear[2], 1.0}},
                               {"metallicFactor", 0.0},
                               {"roughnessFactor", kPlasticRoughness}}}});
    }
    return materials;
}

// One for the positions, one a group of faces, and the primitives that use them.
void addAccessors(const SurfaceMesh& mesh, const FaceGroups& groups, const MeshSpace& space, Json& root) {
    std::array<float, 3> low{};
    std::array<float, 3> high{};
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (const openvdb::Vec3s& point : mesh.points) {
        const auto at = placed(point, space);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], at[axis]);
            high[axis] = std::max(high[axis], at[axis]);
        }
    }
    Json accessors = Json::array();
    accessors.push_back({{"bufferView", 0},
                         {"componentType", kFloat},
                         {"count", mesh.points.size()},
                         {"type", "VEC3"},
                         {"min", low},
                         {"max", high}});
    Json primitives = Json::array();
    std::uint64_t offset = 0;
    for (std::size_t group = 0; group < groups.count(); ++group) {
        const std::uint64_t triangles = groups.triangles(group);
        if (triangles == 0) continue;
        Json primitive{{"attributes", {{"POSITION", 0}}}, {"indices", accessors.size()}};
        if (!mesh.materials.empty()) primitive["material"] = group;
        primitives.push_back(std::move(primitive));
        accessors.push_back({{"bufferView", 1},
                             {"byteOffset", offset},
                             {"componentType", kUnsignedInt},
                             {"count", 3 * triangles},
                             {"type", "SCALAR"}});
        offset += kBytesPerItem * triangles;
    }
    root["meshes"] = {{{"name", "print"}, {"primitives", std::move(primitives)}}};
    root["accessors"] = std::move(accessors);
}

std::string headOf(const SurfaceMesh& mesh, const FaceGroups& groups, const MeshSpace& space) {
    Json root{{"asset", {{"version", "2.0"}, {"generator", fmt::format("Stratum {}", STRATUM_VERSION)}}}};
    // The specification allows no empty lists: nothing is a scene without nodes.
    if (mesh.faces.empty()) return root.dump();
    root["scene"] = 0;
    root["scenes"] = {{{"nodes", {0}}}};
    root["nodes"] = {{{"name", "print"}, {"mesh", 0}}};
    addAccessors(mesh, groups, space, root);
    if (!mesh.materials.empty()) root["materials"] = materialsOf(mesh);
    const std::uint64_t points = kBytesPerItem * mesh.points.size();
    const std::uint64_t indices = kBytesPerItem * mesh.triangleCount();
    root["bufferViews"] = {
        {{"buffer", 0}, {"byteLength", points}, {"target", kArrayBuffer}},
        {{"buffer", 0}, {"byteOffset", points}, {"byteLength", indices}, {"target", kElementArrayBuffer}}};
    root["buffers"] = {{{"byteLength", points + indices}}};
    return root.dump();
}

}  // namespace

void requireGlbSize(std::size_t points, std::size_t triangles, const std::filesystem::path& path) {
    constexpr std::uint64_t kMostHead = 1 << 20;  // of the list of materials, with room to spare
    const std::uint64_t bytes = kBytesPerItem * (points + triangles) + kMostHead;
    if (bytes > std::numeric_limits<std::uint32_t>::max())
        throw UsageError(
            fmt::format("{}: {} triangles need {} bytes, and a .glb can have 4 GiB; choose a larger voxel or a .ply",
                        path.string(), triangles, bytes));
}

void writeGlb(const SurfaceMesh& mesh, const std::filesystem::path& path, const MeshSpace& space) {
    requireGlbSize(mesh.points.size(), mesh.triangleCount(), path);
    FileWriter out(path);
    const FaceGroups groups(mesh);
    std::string head = headOf(mesh, groups, space);
    head.resize((head.size() + 3) / 4 * 4, ' ');
    const std::uint64_t binary = kBytesPerItem * (mesh.points.size() + mesh.triangleCount());
    constexpr std::uint64_t kHeaders = 12 + 8 + 8;
    const std::uint64_t total = kHeaders + head.size() + binary;
    out.raw(kMagic);
    out.raw(kVersion);
    out.raw(static_cast<std::uint32_t>(mesh.faces.empty() ? total - 8 - binary : total));
    out.raw(static_cast<std::uint32_t>(head.size()));
    out.raw(kJsonChunk);
    out.text(head);
    if (!mesh.faces.empty()) {
        out.raw(static_cast<std::uint32_t>(binary));
        out.raw(kBinaryChunk);
        for (const openvdb::Vec3s& point : mesh.points)
            for (const float number : placed(point, space)) out.raw(number);
        for (std::size_t group = 0; group < groups.count(); ++group)
            groups.forEachTriangle(mesh, group, [&out](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                out.raw(a);
                out.raw(b);
                out.raw(c);
            });
    }
    out.commit();
}

}  // namespace stratum::exporter
