#include "study/polygons/triangle_mesh.h"

#include "base/error.h"
#include "base/input_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace stratum::study {
namespace {

std::uint32_t number(int n) { return static_cast<std::uint32_t>(n); }

glm::dvec3 vectorOf(const nlohmann::json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

}  // namespace

void TriangleMesh::append(const TriangleMesh& other, std::uint32_t object) {
    const auto base = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), other.corners.begin(), other.corners.end());
    for (const glm::uvec3& t : other.triangles) triangles.push_back(t + base);
    objects.resize(triangles.size(), object);
}

TriangleMesh sphereMesh(const glm::dvec3& center, double radius, int rings) {
    TriangleMesh mesh;
    mesh.corners.push_back(center + glm::dvec3(0, 0, radius));
    for (int ring = 1; ring < rings; ++ring)
        for (int k = 0; k < rings; ++k) {
            const double down = std::numbers::pi * ring / rings;
            const double turn = 2 * std::numbers::pi * k / rings;
            mesh.corners.push_back(center + radius * glm::dvec3(std::sin(down) * std::cos(turn),
                                                                std::sin(down) * std::sin(turn), std::cos(down)));
        }
    mesh.corners.push_back(center - glm::dvec3(0, 0, radius));
    const auto at = [rings](int ring, int k) { return number(1 + (ring - 1) * rings + k % rings); };
    const auto last = static_cast<std::uint32_t>(mesh.corners.size() - 1);
    for (int k = 0; k < rings; ++k) {
        mesh.triangles.emplace_back(0, at(1, k), at(1, k + 1));
        for (int ring = 1; ring + 1 < rings; ++ring) {
            mesh.triangles.emplace_back(at(ring, k), at(ring + 1, k), at(ring + 1, k + 1));
            mesh.triangles.emplace_back(at(ring, k), at(ring + 1, k + 1), at(ring, k + 1));
        }
        mesh.triangles.emplace_back(last, at(rings - 1, k + 1), at(rings - 1, k));
    }
    mesh.objects.assign(mesh.triangles.size(), 0);
    return mesh;
}

TriangleMesh boxMesh(const glm::dvec3& center, const glm::dvec3& half_extents) {
    TriangleMesh mesh;
    for (int n = 0; n < 8; ++n)
        mesh.corners.push_back(
            center + half_extents * glm::dvec3((n & 1) != 0 ? 1 : -1, (n & 2) != 0 ? 1 : -1, (n & 4) != 0 ? 1 : -1));
    // Each side as four corners around, seen from outside.
    constexpr std::uint32_t kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& s : kSides) {
        mesh.triangles.emplace_back(s[0], s[1], s[2]);
        mesh.triangles.emplace_back(s[0], s[2], s[3]);
    }
    mesh.objects.assign(12, 0);
    return mesh;
}

TriangleMesh cylinderMesh(const glm::dvec3& center, double radius, double half_height, int axis, int points) {
    TriangleMesh mesh;
    // x and y follow the axis in turn, so that the three are right-handed.
    const auto place = [&](double x, double y, double z) {
        glm::dvec3 p;
        p[axis] = z;
        p[(axis + 1) % 3] = x;
        p[(axis + 2) % 3] = y;
        mesh.corners.push_back(center + p);
    };
    place(0, 0, -half_height);
    place(0, 0, half_height);
    for (int k = 0; k < points; ++k)
        for (const double z : {-half_height, half_height})
            place(radius * std::cos(2 * std::numbers::pi * k / points),
                  radius * std::sin(2 * std::numbers::pi * k / points), z);
    for (int k = 0; k < points; ++k) {
        const std::uint32_t low = number(2 + 2 * k);
        const std::uint32_t next = number(2 + 2 * ((k + 1) % points));
        mesh.triangles.emplace_back(low, next, next + 1);
        mesh.triangles.emplace_back(low, next + 1, low + 1);
        mesh.triangles.emplace_back(0, next, low);
        mesh.triangles.emplace_back(1, low + 1, next + 1);
    }
    mesh.objects.assign(mesh.triangles.size(), 0);
    return mesh;
}

TriangleMesh sceneMesh(const std::filesystem::path& scene, int sphere_rings, int cylinder_points) {
    TriangleMesh mesh;
    try {
        const auto json = nlohmann::json::parse(InputFile(scene).bytes(), nullptr, true, true);
        std::uint32_t object = 0;
        for (const auto& entry : json.at("objects")) {
            const auto found = entry.at("sdf").begin();
            const std::string& kind = found.key();
            const nlohmann::json& shape = found.value();
            const glm::dvec3 center = vectorOf(shape.at("center"));
            if (kind == "sphere") {
                mesh.append(sphereMesh(center, shape.at("radius").get<double>(), sphere_rings), object);
            } else if (kind == "box") {
                mesh.append(boxMesh(center, vectorOf(shape.at("half_extents"))), object);
            } else if (kind == "cylinder") {
                const int axis = shape.value("axis", "z")[0] - 'x';
                mesh.append(cylinderMesh(center, shape.at("radius").get<double>(),
                                         shape.at("half_height").get<double>(), axis, cylinder_points),
                            object);
            } else {
                throw InputError(
                    fmt::format("{}: object {}: {}: only spheres, boxes and cylinders have a mesh here; "
                                "leave it out",
                                scene.string(), object, kind));
            }
            ++object;
        }
    } catch (const nlohmann::json::exception& error) {
        throw InputError(fmt::format("{}: has no mesh: {}; objects must be shapes with all their numbers",
                                     scene.string(), error.what()));
    }
    return mesh;
}

}  // namespace stratum::study
