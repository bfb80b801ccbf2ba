#include "shade/camera/camera.h"

#include "base/error.h"
#include "base/names.h"
#include "trace/box_corners.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::shade {
namespace {

/// Three-quarter view from the front right, 28 degrees above the bed: lower than a true isometric view.
const glm::dvec3 kIso = {-std::cos(28.0 * std::numbers::pi / 180.0) * std::sin(35.0 * std::numbers::pi / 180.0),
                         std::cos(28.0 * std::numbers::pi / 180.0) * std::cos(35.0 * std::numbers::pi / 180.0),
                         -std::sin(28.0 * std::numbers::pi / 180.0)};

// From the camera into the scene, in the order of View.
const std::array<glm::dvec3, kViews.size()> kForwards = {
    {kIso, {0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}}};

bool allFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::dvec3 defaultUp(const glm::dvec3& forward) {
    return std::abs(forward.z) > 0.9999 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
}

/// One image axis of the fit: points (a, depth) must be seen within +-slope from the eye (position, back).
struct Axis {
    std::vector<double> a, depth;
    double slope = 1.0;

    /// Depth of the one eye whose two bounding lines of this slope both touch the points.
    double tightest() const {
        double high = -std::numeric_limits<double>::infinity();
        double low = high;
        for (std::size_t i = 0; i < a.size(); ++i) {
            high = std::max(high, a[i] - slope * depth[i]);
            low = std::max(low, -a[i] - slope * depth[i]);
        }
        return -(high + low) / (2.0 * slope);
    }
    /// Position at this depth from which the points are seen equally far to both sides.
    double centered(double back) const {
        double narrow = 0.0;
        double wide = slope;
        double position = 0.0;
        for (int i = 0; i < 64; ++i) {
            const double s = 0.5 * (narrow + wide);
            double from = -std::numeric_limits<double>::infinity();
            double to = -from;
            for (std::size_t k = 0; k < a.size(); ++k) {
                from = std::max(from, a[k] - s * (depth[k] - back));
                to = std::min(to, a[k] + s * (depth[k] - back));
            }
            position = 0.5 * (from + to);
            (from <= to ? wide : narrow) = s;
        }
        return position;
    }
};

}  // namespace

void CameraOptions::validate() const {
    if (!(fov > 0.0 && fov <= 170.0))
        throw UsageError(fmt::format("--fov {}: must be above 0 and at most 170 degrees", fov));
    if (!(margin >= 0.0 && margin <= 0.45))
        throw UsageError(fmt::format("the margin is {}; it must be from 0 to 0.45 of the frame", margin));
    if (!(zoom >= 0.05 && zoom <= 50.0)) throw UsageError(fmt::format("--zoom {}: must be from 0.05 to 50", zoom));
    if (look_at && !eye) throw UsageError("--look-at needs --eye; give both, or choose a --view");
    if ((eye && !allFinite(*eye)) || (look_at && !allFinite(*look_at)) || (up && !allFinite(*up)))
        throw UsageError("--eye, --look-at and --up must be finite numbers");
    if (!(aperture >= 0.0 && std::isfinite(aperture)))
        throw UsageError(fmt::format("--aperture {}: must be a finite number, not negative", aperture));
    if (!(f_number >= 0.0 && std::isfinite(f_number)))
        throw UsageError(fmt::format("--f-number {}: must be a finite number above 0, e.g. 2.8", f_number));
    if (aperture > 0.0 && f_number > 0.0) throw UsageError("--aperture and --f-number say the same; give one");
    if (focus_distance && focus_point) throw UsageError("--focus: a distance or a point, not both");
    if (focus_distance && !(*focus_distance > 0.0 && std::isfinite(*focus_distance)))
        throw UsageError(fmt::format("--focus {}: a distance must be a finite number above 0", *focus_distance));
    if (focus_point && !allFinite(*focus_point)) throw UsageError("--focus: the point must be finite numbers");
    if ((focus_distance || focus_point) && !(aperture > 0.0 || f_number > 0.0))
        throw UsageError("--focus needs a lens; give --f-number or --aperture, too");
}

Camera::Camera(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double fov, int width,
               int height)
    : eye_(eye), fov_(fov), tan_half_(std::tan(0.5 * fov * std::numbers::pi / 180.0)), width_(width), height_(height) {
    const glm::dvec3 line = look_at - eye;
    if (!(glm::length(line) > 0.0)) throw UsageError("--eye and --look-at are the same point; move one of them");
    forward_ = glm::normalize(line);
    const glm::dvec3 side = glm::cross(forward_, up);
    if (!(glm::length(side) > 1e-9 * glm::length(up)))
        throw UsageError("--up is parallel to the line of sight (or zero); choose another, e.g. 0,1,0");
    right_ = glm::normalize(side);
    up_ = glm::cross(right_, forward_);
}

namespace {

/// Points around all that these pass through when they turn about the vertical axis through `middle`.
std::vector<glm::dvec3> turnedAround(const std::vector<glm::dvec3>& points, const glm::dvec3& middle) {
    constexpr int kSides = 16;
    std::vector<glm::dvec3> around;
    around.reserve(points.size() * kSides);
    for (const glm::dvec3& point : points) {
        // The corners of a polygon around the circle.
        const double radius = std::hypot(point.x - middle.x, point.y - middle.y) / std::cos(std::numbers::pi / kSides);
        for (int n = 0; n < kSides; ++n) {
            const double angle = 2.0 * std::numbers::pi * n / kSides;
            around.emplace_back(middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle), point.z);
        }
    }
    return around;
}

/// The camera with the lens of the options.
Camera focused(const Camera& camera, const CameraOptions& options, const trace::Box& box) {
    double radius = 0.5 * options.aperture;
    if (options.f_number > 0.0) {
        constexpr double kPictureHeight = 24.0;  // mm, as on film
        const double focal = 0.5 * kPictureHeight / std::tan(0.5 * camera.fov() * std::numbers::pi / 180.0);
        radius = 0.5 * focal / options.f_number / options.mm_per_unit;
    }
    if (!(radius > 0.0)) return camera;
    const glm::dvec3 target = options.focus_point.value_or(0.5 * (box.min + box.max));
    const double focus = options.focus_distance.value_or(glm::dot(target - camera.eye(), camera.forward()));
    if (!(focus > 0.0))
        throw UsageError(
            "--focus: what should be sharp is not in front of the camera; give a distance, or another point");
    return camera.withLens(radius, focus);
}

}  // namespace

Camera Camera::make(const CameraOptions& options, const trace::Box& box, int width, int height,
                    std::span<const glm::dvec3> outline) {
    options.validate();
    return focused(fitted(options, box, outline, width, height).zoomed(options.zoom), options, box);
}

Camera Camera::fitted(const CameraOptions& options, const trace::Box& box, std::span<const glm::dvec3> outline,
                      int width, int height) {
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    if (options.eye) {
        const glm::dvec3 target = options.look_at.value_or(middle);
        const glm::dvec3 line = target - *options.eye;
        const double length = glm::length(line);
        return {
            *options.eye, target, options.up.value_or(length > 0.0 ? defaultUp(line / length) : glm::dvec3(0, 0, 1)),
            options.fov,  width,  height};
    }
    const glm::dvec3 forward = kForwards[static_cast<std::size_t>(options.view)];
    Camera camera(middle, middle + forward, options.up.value_or(defaultUp(forward)), options.fov, width, height);

    std::vector<glm::dvec3> points(outline.begin(), outline.end());
    if (points.empty()) {
        const auto corners = trace::cornersOf(box);
        points.assign(corners.begin(), corners.end());
    }
    camera.fit(middle, options.all_around ? turnedAround(points, middle) : points, options.margin);
    return camera;
}

void Camera::fit(const glm::dvec3& middle, const std::vector<glm::dvec3>& points, double margin) {
    // In view space each pair of opposite frustum planes is a problem in the plane of one image axis and depth.
    const double room = tan_half_ * (1.0 - 2.0 * margin);
    Axis x;
    Axis y;
    x.slope = room * width_ / height_;
    y.slope = room;
    double size = 0.0;
    for (const glm::dvec3& point : points) {
        const glm::dvec3 d = point - middle;
        x.a.push_back(glm::dot(d, right_));
        y.a.push_back(glm::dot(d, up_));
        x.depth.push_back(glm::dot(d, forward_));
        size = std::max(size, glm::length(d));
    }
    y.depth = x.depth;
    // What has no size has no distance of its own.
    const double back = size > 0.0 ? std::min(x.tightest(), y.tightest()) : -1.0;
    eye_ = middle + back * forward_ + x.centered(back) * right_ + y.centered(back) * up_;
}

Camera Camera::zoomed(double factor) const {
    if (factor == 1.0) return *this;
    Camera camera = *this;
    camera.tan_half_ /= factor;
    camera.fov_ = 2.0 * std::atan(camera.tan_half_) * 180.0 / std::numbers::pi;
    return camera;
}

Camera Camera::withLens(double radius, double focus) const {
    Camera camera = *this;
    camera.lens_radius_ = radius;
    camera.focus_ = focus;
    return camera;
}

Camera Camera::turned(double degrees, const glm::dvec3& about) const {
    const double s = std::sin(degrees * std::numbers::pi / 180.0);
    const double c = std::cos(degrees * std::numbers::pi / 180.0);
    const auto turn = [s, c](const glm::dvec3& v) { return glm::dvec3(c * v.x - s * v.y, s * v.x + c * v.y, v.z); };
    Camera camera = *this;
    camera.eye_ = about + turn(eye_ - about);
    camera.right_ = turn(right_);
    camera.up_ = turn(up_);
    camera.forward_ = turn(forward_);
    return camera;
}

trace::Ray Camera::ray(const glm::dvec2& pixel, const glm::vec2& u) const {
    const double scale = 2.0 * tan_half_ / height_;
    const double x = (pixel.x - 0.5 * width_) * scale;
    const double y = (0.5 * height_ - pixel.y) * scale;
    // All rays of a pixel meet in the plane of focus.
    const double radius = lens_radius_ * std::sqrt(static_cast<double>(u.x));
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(u.y);
    const glm::dvec3 offset = radius * (std::cos(angle) * right_ + std::sin(angle) * up_);
    trace::Ray ray;
    ray.origin = eye_ + offset;
    ray.direction = glm::normalize(focus_ * (forward_ + x * right_ + y * up_) - offset);
    return ray;
}

std::optional<glm::dvec2> Camera::project(const glm::dvec3& point) const {
    const glm::dvec3 d = point - eye_;
    const double depth = glm::dot(d, forward_);
    if (!(depth > 0.0)) return std::nullopt;
    const double scale = height_ / (2.0 * tan_half_ * depth);
    return glm::dvec2(0.5 * width_ + glm::dot(d, right_) * scale, 0.5 * height_ - glm::dot(d, up_) * scale);
}

}  // namespace stratum::shade
