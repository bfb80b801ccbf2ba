// Models of which distances are known.
#pragma once

#include "compare/closed_model.h"
#include "compare/rigid.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace stratum::test {

inline compare::TriangleMesh boxModel(const glm::dvec3& low, const glm::dvec3& high) {
    compare::TriangleMesh mesh;
    for (int n = 0; n < 8; ++n)
        mesh.points.emplace_back((n & 4) != 0 ? high.x : low.x, (n & 2) != 0 ? high.y : low.y,
                                 (n & 1) != 0 ? high.z : low.z);
    constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                            {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& f : kFaces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

// By latitude and longitude.
inline compare::TriangleMesh ellipsoidModel(const glm::dvec3& half, int rings) {
    compare::TriangleMesh mesh;
    const int sectors = 2 * rings;
    mesh.points.emplace_back(0, 0, -half.z);
    for (int r = 1; r < rings; ++r)
        for (int s = 0; s < sectors; ++s) {
            const double polar = std::numbers::pi * r / rings;
            const double angle = 2 * std::numbers::pi * s / sectors;
            mesh.points.emplace_back(half.x * std::sin(polar) * std::cos(angle),
                                     half.y * std::sin(polar) * std::sin(angle), -half.z * std::cos(polar));
        }
    mesh.points.emplace_back(0, 0, half.z);
    const auto at = [&](int r, int s) {
        if (r == 0) return 0U;
        if (r == rings) return static_cast<std::uint32_t>(mesh.points.size() - 1);
        return static_cast<std::uint32_t>(1 + (r - 1) * sectors + s % sectors);
    };
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sectors; ++s) {
            if (r > 0) mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
            if (r + 1 < rings) mesh.triangles.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
        }
    return mesh;
}

// An L: a shape without a symmetry but a plane.
inline compare::TriangleMesh angleModel() {
    compare::TriangleMesh mesh;
    const double plan[6][2] = {{0, 0}, {20, 0}, {20, 5}, {6, 5}, {6, 12}, {0, 12}};
    for (const double z : {0.0, 8.0})
        for (const auto& p : plan) mesh.points.emplace_back(p[0], p[1], z);
    constexpr std::uint32_t kTop[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    for (const auto& t : kTop) {
        mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
        mesh.triangles.push_back({t[0], t[2], t[1]});
    }
    for (std::uint32_t n = 0; n < 6; ++n) {
        const std::uint32_t next = (n + 1) % 6;
        mesh.triangles.push_back({n, next, next + 6});
        mesh.triangles.push_back({n, next + 6, n + 6});
    }
    return mesh;
}

inline compare::TriangleMesh moved(compare::TriangleMesh mesh, const compare::Rigid& by) {
    for (glm::dvec3& p : mesh.points) p = by(p);
    return mesh;
}

/// Numbers in 0..1 from a seed.
class Numbers {
public:
    explicit Numbers(std::uint32_t seed) : state_(seed) {}
    double operator()() {
        state_ = state_ * 1664525U + 1013904223U;
        return (state_ >> 8) * 0x1p-24;
    }

private:
    std::uint32_t state_;
};

}  // namespace stratum::test
