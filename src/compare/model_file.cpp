#include "compare/model_file.h"

#include "base/error.h"
#include "base/text.h"
#include "compare/reader_process.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <zip.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace stratum::compare {
namespace {

// The element <model> is the first of its file.
constexpr std::size_t kHead = 65536;

struct Discard {
    void operator()(zip_t* archive) const { zip_discard(archive); }
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};

struct StatedUnit {
    std::string_view name;
    double mm;
};
constexpr std::array kStatedUnits{StatedUnit{"micron", 0.001},  StatedUnit{"millimeter", 1},
                                  StatedUnit{"centimeter", 10}, StatedUnit{"inch", 25.4},
                                  StatedUnit{"foot", 304.8},    StatedUnit{"meter", 1000}};

// The beginning of the model's XML; empty where there is none.
std::string headOf(const std::string& name) {
    const std::unique_ptr<zip_t, Discard> archive(zip_open(name.c_str(), ZIP_RDONLY, nullptr));
    if (!archive) return {};
    zip_int64_t model = zip_name_locate(archive.get(), "3D/3dmodel.model", ZIP_FL_NOCASE);
    for (zip_int64_t n = 0; model < 0 && n < zip_get_num_entries(archive.get(), 0); ++n) {
        const char* entry = zip_get_name(archive.get(), static_cast<zip_uint64_t>(n), 0);
        if (entry != nullptr && lowerCase(entry).ends_with(".model")) model = n;
    }
    if (model < 0) return {};
    const std::unique_ptr<zip_file_t, Discard> file(
        zip_fopen_index(archive.get(), static_cast<zip_uint64_t>(model), 0));
    if (!file) return {};
    std::string text(kHead, '\0');
    const zip_int64_t read = zip_fread(file.get(), text.data(), text.size());
    text.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
    return text;
}

// The value of the attribute in the tag; empty if it isn't there.
std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
        if (at == 0 || std::string_view(" \t\r\n").find(tag[at - 1]) == std::string_view::npos) continue;
        std::string_view rest = tag.substr(at + name.size());
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
        if (!rest.starts_with('=')) continue;
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n", 1), rest.size()));
        if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) continue;
        return rest.substr(1, rest.find(rest.front(), 1) - 1);
    }
    return {};
}

}  // namespace

double unitOfModel(const std::filesystem::path& path) {
    if (lowerCase(path.extension().string()) != ".3mf") return 1;
    std::string head = headOf(path.string());
    for (std::size_t at = head.find("<!--"); at != std::string::npos; at = head.find("<!--", at)) {
        const std::size_t end = head.find("-->", at);
        head.erase(at, end == std::string::npos ? end : end + 3 - at);
    }
    const std::size_t begin = head.find("<model");
    if (begin == std::string::npos) return 1;
    const std::string_view tag = std::string_view(head).substr(begin, head.find('>', begin) - begin);
    const std::string_view stated = attribute(tag, "unit");
    if (stated.empty()) return 1;
    for (const StatedUnit& unit : kStatedUnits)
        if (stated == unit.name) return unit.mm;
    throw InputError(
        fmt::format("{}: its unit is \"{}\"; expected micron, millimeter, centimeter, inch, foot or meter; export the "
                    "model again",
                    path.string(), stated));
}

namespace {

auto orderOf(const glm::dvec3& p) { return std::tie(p.x, p.y, p.z); }

// STL has every corner three times or more.
void mergeEqualPoints(TriangleMesh& mesh) {
    std::vector<std::uint32_t> order(mesh.points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&mesh](std::uint32_t a, std::uint32_t b) { return orderOf(mesh.points[a]) < orderOf(mesh.points[b]); });
    std::vector<std::uint32_t> place(mesh.points.size());
    std::vector<glm::dvec3> merged;
    for (const std::uint32_t n : order) {
        if (merged.empty() || merged.back() != mesh.points[n]) merged.push_back(mesh.points[n]);
        place[n] = static_cast<std::uint32_t>(merged.size() - 1);
    }
    mesh.points = std::move(merged);
    for (Triangle& triangle : mesh.triangles)
        for (std::uint32_t& corner : triangle) corner = place[corner];
    std::erase_if(mesh.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

[[noreturn]] void refuseCount(const std::string& name) {
    throw InputError(fmt::format("{}: more than {} triangles; simplify the model", name, kMostTriangles));
}

void append(const aiMesh& part, const aiMatrix4x4& place, const std::string& name, TriangleMesh& mesh) {
    if (mesh.triangles.size() + part.mNumFaces > kMostTriangles) refuseCount(name);
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (unsigned n = 0; n < part.mNumVertices; ++n) {
        const aiVector3D p = place * part.mVertices[n];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            throw InputError(fmt::format("{}: point {} is not finite; export the model again", name, n + 1));
        mesh.points.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned n = 0; n < part.mNumFaces; ++n) {
        const aiFace& face = part.mFaces[n];
        for (unsigned corner = 0; corner < face.mNumIndices; ++corner)
            if (face.mIndices[corner] >= part.mNumVertices)
                throw InputError(
                    fmt::format("{}: face {} has a corner that is no point; export the model again", name, n + 1));
        if (face.mNumIndices != 3) continue;
        Triangle triangle{first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]};
        if (place.Determinant() < 0) std::swap(triangle[1], triangle[2]);  // an item that the .3mf mirrors
        mesh.triangles.push_back(triangle);
    }
}

void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, const std::string& name,
            TriangleMesh& mesh) {
    const aiMatrix4x4 place = above * node.mTransformation;
    for (unsigned n = 0; n < node.mNumMeshes; ++n) append(*scene.mMeshes[node.mMeshes[n]], place, name, mesh);
    for (unsigned n = 0; n < node.mNumChildren; ++n) append(scene, *node.mChildren[n], place, name, mesh);
}

TriangleMesh readByAssimp(const std::string& name) {
    Assimp::Importer importer;
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate | aiProcess_SortByPType);
    if (scene == nullptr)
        throw InputError(fmt::format("{}: can't be read as a model: {}; export it again as STL, 3MF or OBJ", name,
                                     importer.GetErrorString()));
    TriangleMesh mesh;
    append(*scene, *scene->mRootNode, aiMatrix4x4(), name, mesh);
    mergeEqualPoints(mesh);
    const double unit = unitOfModel(name);
    for (glm::dvec3& p : mesh.points) p *= unit;
    return mesh;
}

// The number of points, the points, the triangles.
std::string packed(const TriangleMesh& mesh) {
    const std::uint64_t points = mesh.points.size();
    std::string bytes;
    const auto append = [&bytes](const void* data, std::size_t size) {
        bytes.append(static_cast<const char*>(data), size);
    };
    append(&points, sizeof points);
    append(mesh.points.data(), mesh.points.size() * sizeof mesh.points[0]);
    append(mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
    return bytes;
}

TriangleMesh unpacked(std::string_view bytes) {
    std::uint64_t points = 0;
    std::memcpy(&points, bytes.data(), sizeof points);
    bytes.remove_prefix(sizeof points);
    TriangleMesh mesh;
    const auto take = [&bytes](auto& to, std::size_t count) {
        to.resize(count);
        if (count > 0) std::memcpy(static_cast<void*>(to.data()), bytes.data(), count * sizeof to[0]);
        bytes.remove_prefix(count * sizeof to[0]);
    };
    take(mesh.points, points);
    take(mesh.triangles, bytes.size() / sizeof(Triangle));
    return mesh;
}

}  // namespace

bool isModelPath(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    return extension == ".stl" || extension == ".3mf" || extension == ".obj";
}

TriangleMesh readModel(const std::filesystem::path& path) {
    const std::string name = path.string();
    if (!isModelPath(path))
        throw InputError(fmt::format("{}: is no model by its name; expected .stl, .3mf or .obj", name));
    if (!std::filesystem::is_regular_file(path)) throw InputError(fmt::format("{}: no such file", name));
    // Assimp 5.2 asserts what damaged files do not hold.
    TriangleMesh mesh = unpacked(readInProcess(name, [&name] { return packed(readByAssimp(name)); }));
    if (mesh.triangles.empty())
        throw InputError(
            fmt::format("{}: has no triangles; expected a solid model, exported as STL, 3MF or OBJ", name));
    return mesh;
}

}  // namespace stratum::compare
