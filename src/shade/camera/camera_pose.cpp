#include "shade/camera/camera_pose.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace stratum::shade {
namespace {

constexpr std::size_t kFewest = 6;
constexpr double kFlat = 1e-3;  // thickness of the points over their spread; less counts as a plane

template <std::size_t N>
using Matrix = std::array<std::array<double, N>, N>;

/// Eigenvalues, ascending, and vectors (as rows) of a symmetric matrix, by Jacobi's rotations.
template <std::size_t N>
std::pair<std::array<double, N>, Matrix<N>> eigen(Matrix<N> a) {
    Matrix<N> v{};
    for (std::size_t i = 0; i < N; ++i) v[i][i] = 1;
    for (int sweep = 0; sweep < 60; ++sweep) {
        double off = 0;
        for (std::size_t p = 0; p < N; ++p)
            for (std::size_t q = p + 1; q < N; ++q) off += a[p][q] * a[p][q];
        if (!(off > 0)) break;
        for (std::size_t p = 0; p < N; ++p)
            for (std::size_t q = p + 1; q < N; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1);
                const double s = t * c;
                for (std::size_t k = 0; k < N; ++k) {
                    const double kp = a[k][p];
                    const double kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (std::size_t k = 0; k < N; ++k) {
                    const double pk = a[p][k];
                    const double qk = a[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                    const double vp = v[p][k];
                    const double vq = v[q][k];
                    v[p][k] = c * vp - s * vq;
                    v[q][k] = s * vp + c * vq;
                }
            }
    }
    std::array<std::size_t, N> order{};
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return a[x][x] < a[y][y]; });
    std::pair<std::array<double, N>, Matrix<N>> sorted;
    for (std::size_t i = 0; i < N; ++i) {
        sorted.first[i] = a[order[i]][order[i]];
        sorted.second[i] = v[order[i]];
    }
    return sorted;
}

/// A pinhole: rows of `rotation` are the picture's right, down and forward.
struct Pinhole {
    std::array<glm::dvec3, 3> rows;
    glm::dvec3 eye{0.0};
    double focal = 1.0;  // pixels

    /// From the middle of the picture, y down.
    glm::dvec2 project(const glm::dvec3& p) const {
        const glm::dvec3 d = p - eye;
        const double depth = glm::dot(rows[2], d);
        return {focal * glm::dot(rows[0], d) / depth, focal * glm::dot(rows[1], d) / depth};
    }
    /// Moved by small steps: three turns (radians, about the picture's axes), three shifts along them, log of focal.
    Pinhole stepped(const std::array<double, 7>& by, double size) const {
        Pinhole other = *this;
        const glm::dvec3 turn(by[0], by[1], by[2]);
        const double angle = glm::length(turn);
        if (angle > 0) {
            const glm::dvec3 axis = (turn.x * rows[0] + turn.y * rows[1] + turn.z * rows[2]) / angle;
            for (glm::dvec3& row : other.rows)
                row = std::cos(angle) * row + std::sin(angle) * glm::cross(axis, row) +
                      (1 - std::cos(angle)) * glm::dot(axis, row) * axis;
        }
        other.eye += size * (by[3] * rows[0] + by[4] * rows[1] + by[5] * rows[2]);
        other.focal *= std::exp(by[6]);
        return other;
    }
};

double costOf(const Pinhole& camera, const std::vector<PointPair>& pairs) {
    double sum = 0;
    for (const PointPair& pair : pairs) {
        const glm::dvec2 off = camera.project(pair.point) - pair.pixel;
        sum += glm::dot(off, off);
        // Points behind the camera have no projection.
        if (!(glm::dot(camera.rows[2], pair.point - camera.eye) > 0)) return std::numeric_limits<double>::infinity();
    }
    return sum;
}

/// Solves a x = b for a symmetric positive matrix by Gauss' elimination with pivots; false if it can't.
bool solve(Matrix<7> a, std::array<double, 7> b, std::array<double, 7>& x) {
    for (std::size_t c = 0; c < 7; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < 7; ++r)
            if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
        if (!(std::abs(a[pivot][c]) > 0)) return false;
        std::swap(a[c], a[pivot]);
        std::swap(b[c], b[pivot]);
        for (std::size_t r = c + 1; r < 7; ++r) {
            const double f = a[r][c] / a[c][c];
            for (std::size_t k = c; k < 7; ++k) a[r][k] -= f * a[c][k];
            b[r] -= f * b[c];
        }
    }
    for (std::size_t c = 7; c-- > 0;) {
        double sum = b[c];
        for (std::size_t k = c + 1; k < 7; ++k) sum -= a[c][k] * x[k];
        x[c] = sum / a[c][c];
    }
    return true;
}

Pinhole refined(Pinhole camera, const std::vector<PointPair>& pairs, double size) {
    double cost = costOf(camera, pairs);
    double damping = 1e-3;
    for (int round = 0; round < 200; ++round) {
        Matrix<7> normal{};
        std::array<double, 7> slope{};
        constexpr double kStep = 1e-6;
        for (const PointPair& pair : pairs) {
            const glm::dvec2 off = camera.project(pair.point) - pair.pixel;
            std::array<glm::dvec2, 7> j;
            for (std::size_t k = 0; k < 7; ++k) {
                std::array<double, 7> by{};
                by[k] = kStep;
                const glm::dvec2 after = camera.stepped(by, size).project(pair.point);
                by[k] = -kStep;
                j[k] = (after - camera.stepped(by, size).project(pair.point)) / (2 * kStep);
            }
            for (std::size_t r = 0; r < 7; ++r) {
                slope[r] -= glm::dot(j[r], off);
                for (std::size_t c = 0; c < 7; ++c) normal[r][c] += glm::dot(j[r], j[c]);
            }
        }
        bool better = false;
        for (int attempt = 0; attempt < 12 && !better; ++attempt) {
            Matrix<7> damped = normal;
            for (std::size_t k = 0; k < 7; ++k) damped[k][k] *= 1 + damping;
            std::array<double, 7> by{};
            if (!solve(damped, slope, by)) return camera;
            const Pinhole next = camera.stepped(by, size);
            const double next_cost = costOf(next, pairs);
            better = next_cost < cost;
            if (better) {
                const bool done = cost - next_cost <= 1e-14 * cost;
                camera = next;
                cost = next_cost;
                damping = std::max(0.1 * damping, 1e-12);
                if (done) return camera;
            } else {
                damping *= 10;
            }
        }
        if (!better) break;
    }
    return camera;
}

[[noreturn]] void refuse(std::string_view why) { throw InputError(fmt::format("the camera's pose: {}", why)); }

// The camera by the direct linear transform: the least singular vector of the pairs' equations, made a pinhole camera.
// `scale`: pixels, half the photograph.
Pinhole directSolution(std::span<const PointPair> centered, double scale) {
    Matrix<12> products{};
    for (const PointPair& pair : centered) {
        const glm::dvec3& p = pair.point;
        const glm::dvec2 q = pair.pixel / scale;
        const std::array<double, 12> x{p.x, p.y, p.z, 1, 0, 0, 0, 0, -q.x * p.x, -q.x * p.y, -q.x * p.z, -q.x};
        const std::array<double, 12> y{0, 0, 0, 0, p.x, p.y, p.z, 1, -q.y * p.x, -q.y * p.y, -q.y * p.z, -q.y};
        for (const auto& row : {x, y})
            for (std::size_t r = 0; r < 12; ++r)
                for (std::size_t c = 0; c < 12; ++c) products[r][c] += row[r] * row[c];
    }
    const auto [values, vectors] = eigen(products);
    // A second solution as good as the first: the configuration doesn't determine the camera.
    if (!(values[1] > 1e-10 * values[11]))
        refuse("the points leave more than one pose open; add more, and spread them");
    const auto& v = vectors[0];
    glm::dvec3 m[3] = {{v[0], v[1], v[2]}, {v[4], v[5], v[6]}, {v[8], v[9], v[10]}};
    glm::dvec3 last(v[3], v[7], v[11]);
    double depth = 0;
    for (const PointPair& pair : centered) depth += glm::dot(m[2], pair.point) + last.z;
    const double norm = (depth < 0 ? -1 : 1) * glm::length(m[2]);
    if (!(std::abs(norm) > 0)) refuse("no camera sees these points there; are the pairs in order?");
    for (glm::dvec3& row : m) row /= norm;
    last /= norm;
    Pinhole camera;
    camera.rows[2] = m[2];
    const glm::dvec3 right = m[0] - glm::dot(m[0], m[2]) * m[2];
    const glm::dvec3 down = m[1] - glm::dot(m[1], m[2]) * m[2];
    if (!(glm::length(right) > 0 && glm::length(down) > 0))
        refuse("no camera sees these points there; are the pairs in order?");
    camera.rows[0] = glm::normalize(right);
    camera.rows[1] = glm::cross(camera.rows[2], camera.rows[0]);
    if (!(glm::dot(camera.rows[1], down) > 0))
        refuse("only a mirrored picture shows these points so; pixels count from the upper left corner, y down");
    camera.focal = 0.5 * scale * (glm::length(right) + glm::length(down));
    // The eye is where all three rows are 0.
    const glm::dmat3 rows = glm::transpose(glm::dmat3(m[0], m[1], m[2]));
    if (!(std::abs(glm::determinant(rows)) > 0)) refuse("no camera sees these points there; are the pairs in order?");
    camera.eye = -(glm::inverse(rows) * last);
    return camera;
}

}  // namespace

CameraPose solveCameraPose(std::span<const PointPair> pairs, double width, double height) {
    if (!(width > 0 && height > 0 && std::isfinite(width) && std::isfinite(height)))
        refuse("the photograph's size must be two numbers above 0");
    if (pairs.size() < kFewest)
        refuse(fmt::format("{} matched points; at least {} are needed, not all in a plane", pairs.size(), kFewest));
    // Normalization against rounding errors: points relative to their mean and of unit spread, pixels relative to the
    // picture's middle.
    glm::dvec3 middle(0.0);
    std::vector<PointPair> centered;
    for (const PointPair& pair : pairs) {
        const double sum = pair.pixel.x + pair.pixel.y + pair.point.x + pair.point.y + pair.point.z;
        if (!std::isfinite(sum)) refuse(fmt::format("pair {} has a value that is no finite number", centered.size()));
        centered.push_back({pair.pixel - 0.5 * glm::dvec2(width, height), pair.point});
        middle += pair.point / static_cast<double>(pairs.size());
    }
    Matrix<3> spread{};
    for (PointPair& pair : centered) {
        pair.point -= middle;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                spread[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] += pair.point[r] * pair.point[c];
    }
    const auto axes = eigen(spread).first;
    const double size = std::sqrt(std::max(axes[2], 0.0) / static_cast<double>(pairs.size()));
    if (!(size > 0)) refuse("all points are the same");
    if (!(std::sqrt(std::max(axes[1], 0.0)) > kFlat * std::sqrt(axes[2]))) refuse("the points lie on a line");
    if (!(std::sqrt(std::max(axes[0], 0.0)) > kFlat * std::sqrt(axes[2])))
        refuse("the points lie in a plane, which says too little of the focal length; add some that stand out of it");
    const double scale = 0.5 * std::max(width, height);
    for (PointPair& pair : centered) pair.point /= size;
    const Pinhole camera = refined(directSolution(centered, scale), centered, 1.0);
    CameraPose pose;
    double squares = 0;
    for (std::size_t n = 0; n < centered.size(); ++n) {
        const double off = glm::length(camera.project(centered[n].point) - centered[n].pixel);
        squares += off * off;
        if (!(off <= pose.worst_pixels)) {
            pose.worst_pixels = off;
            pose.worst = n;
        }
    }
    pose.rms_pixels = std::sqrt(squares / static_cast<double>(centered.size()));
    pose.eye = middle + size * camera.eye;
    pose.forward = camera.rows[2];
    pose.up = -camera.rows[1];
    pose.fov = 2 * std::atan(0.5 * height / camera.focal) * 180 / std::numbers::pi;
    if (!std::isfinite(pose.rms_pixels) || !std::isfinite(glm::length(pose.eye)) || !(pose.fov > 0))
        refuse("no camera sees these points there; are the pairs in order?");
    return pose;
}

}  // namespace stratum::shade
