#include "shade/camera/camera_pose.h"

#include "base/error.h"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <unsupported/Eigen/LevenbergMarquardt>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

namespace stratum::shade {
namespace {

constexpr std::size_t kFewest = 6;
constexpr double kFlat = 1e-3;  // thickness of the points over their spread; less counts as a plane

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
    Pinhole stepped(const Eigen::VectorXd& by) const {
        Pinhole other = *this;
        const glm::dvec3 turn(by[0], by[1], by[2]);
        const double angle = glm::length(turn);
        if (angle > 0) {
            const glm::dvec3 axis = (turn.x * rows[0] + turn.y * rows[1] + turn.z * rows[2]) / angle;
            for (glm::dvec3& row : other.rows)
                row = std::cos(angle) * row + std::sin(angle) * glm::cross(axis, row) +
                      (1 - std::cos(angle)) * glm::dot(axis, row) * axis;
        }
        other.eye += by[3] * rows[0] + by[4] * rows[1] + by[5] * rows[2];
        other.focal *= std::exp(by[6]);
        return other;
    }
};

/// The distances in pixels of the pairs' projections, as a function of steps from a camera.
class Distances : public Eigen::DenseFunctor<double> {
public:
    Distances(const Pinhole& camera, const std::vector<PointPair>& pairs)
        : DenseFunctor(kSteps, 2 * static_cast<int>(pairs.size())), camera_(camera), pairs_(pairs) {}

    int operator()(const InputType& by, ValueType& distances) const {
        const Pinhole camera = camera_.stepped(by);
        Eigen::Index n = 0;
        for (const PointPair& pair : pairs_) {
            const glm::dvec2 off = camera.project(pair.point) - pair.pixel;
            // Points behind the camera have no projection.
            const bool seen = glm::dot(camera.rows[2], pair.point - camera.eye) > 0;
            for (int axis = 0; axis < 2; ++axis)
                distances[n++] = seen ? off[axis] : std::numeric_limits<double>::infinity();
        }
        return 0;
    }
    int df(const InputType& by, JacobianType& slopes) const {
        constexpr double kStep = 1e-6;
        for (Eigen::Index k = 0; k < kSteps; ++k) {
            InputType other = by;
            other[k] = by[k] + kStep;
            const Pinhole after = camera_.stepped(other);
            other[k] = by[k] - kStep;
            const Pinhole before = camera_.stepped(other);
            Eigen::Index n = 0;
            for (const PointPair& pair : pairs_) {
                const glm::dvec2 slope = (after.project(pair.point) - before.project(pair.point)) / (2 * kStep);
                for (int axis = 0; axis < 2; ++axis) slopes(n++, k) = slope[axis];
            }
        }
        return 0;
    }

    static constexpr int kSteps = 7;

private:
    const Pinhole& camera_;
    const std::vector<PointPair>& pairs_;
};

/// The camera whose distances have the least sum of squares, found from a camera nearby.
Pinhole refined(const Pinhole& camera, const std::vector<PointPair>& pairs) {
    Distances distances(camera, pairs);
    Eigen::VectorXd by = Eigen::VectorXd::Zero(Distances::kSteps);
    Eigen::VectorXd first(distances.values());
    distances(by, first);
    if (!first.allFinite()) return camera;
    Eigen::LevenbergMarquardt<Distances> search(distances);
    search.setFtol(1e-15);
    search.setXtol(1e-15);
    search.setMaxfev(2000);
    search.minimize(by);
    return camera.stepped(by);
}

[[noreturn]] void refuse(std::string_view why) { throw InputError(fmt::format("the camera's pose: {}", why)); }

// The camera by the direct linear transform: the least singular vector of the pairs' equations, made a pinhole camera.
// `scale`: pixels, half the photograph.
Pinhole directSolution(std::span<const PointPair> centered, double scale) {
    Eigen::Matrix<double, 12, 12> products = Eigen::Matrix<double, 12, 12>::Zero();
    for (const PointPair& pair : centered) {
        const glm::dvec3& p = pair.point;
        const glm::dvec2 q = pair.pixel / scale;
        Eigen::Matrix<double, 12, 1> x;
        Eigen::Matrix<double, 12, 1> y;
        x << p.x, p.y, p.z, 1, 0, 0, 0, 0, -q.x * p.x, -q.x * p.y, -q.x * p.z, -q.x;
        y << 0, 0, 0, 0, p.x, p.y, p.z, 1, -q.y * p.x, -q.y * p.y, -q.y * p.z, -q.y;
        products += x * x.transpose() + y * y.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solved(products);  // values ascend
    const auto& values = solved.eigenvalues();
    // A second solution as good as the first: the configuration doesn't determine the camera.
    if (!(values[1] > 1e-10 * values[11]))
        refuse("the points leave more than one pose open; add more, and spread them");
    const Eigen::Matrix<double, 12, 1> v = solved.eigenvectors().col(0);
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
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (PointPair& pair : centered) {
        pair.point -= middle;
        const Eigen::Vector3d place(pair.point.x, pair.point.y, pair.point.z);
        spread += place * place.transpose();
    }
    const Eigen::Vector3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
    const double size = std::sqrt(std::max(axes[2], 0.0) / static_cast<double>(pairs.size()));
    if (!(size > 0)) refuse("all points are the same");
    if (!(std::sqrt(std::max(axes[1], 0.0)) > kFlat * std::sqrt(axes[2]))) refuse("the points lie on a line");
    if (!(std::sqrt(std::max(axes[0], 0.0)) > kFlat * std::sqrt(axes[2])))
        refuse("the points lie in a plane, which says too little of the focal length; add some that stand out of it");
    const double scale = 0.5 * std::max(width, height);
    for (PointPair& pair : centered) pair.point /= size;
    const Pinhole camera = refined(directSolution(centered, scale), centered);
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
