// The camera: pinhole or thin lens.
#pragma once

#include "base/names.h"
#include "trace/intersector.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <vector>

namespace stratum::shade {

/// Named viewing directions. z is up and the front of a printer is at -y.
enum class View { iso, front, back, left, right, top, bottom };
inline constexpr Names<View, 7> kViews = {{{"iso", View::iso},
                                           {"front", View::front},
                                           {"back", View::back},
                                           {"left", View::left},
                                           {"right", View::right},
                                           {"top", View::top},
                                           {"bottom", View::bottom}}};

struct CameraOptions {
    View view = View::iso;              ///< used unless `eye` is given; the distance is fitted to what is seen
    std::optional<glm::dvec3> eye;      ///< world space
    std::optional<glm::dvec3> look_at;  ///< world space; needs `eye`; default: the middle of the box
    std::optional<glm::dvec3> up;  ///< world space, any length; default: +z, or +y when looking straight up or down
    double fov = 28.0;             ///< degrees, vertical, whole angle, in (0, 170]
    double aperture = 0.0;         ///< diameter of the lens, world units, >= 0; 0 is a pinhole: everything is sharp
    double f_number = 0.0;         ///< or as the f-number of a camera with a sensor 24 mm high; 0: none
    double mm_per_unit = 1.0;      ///< millimetres a world unit, for that lens; > 0
    std::optional<double> focus_distance;   ///< world units from the eye along the viewing direction; > 0
    std::optional<glm::dvec3> focus_point;  ///< or this world-space point is sharp; default: the middle of the box
    bool all_around = false;                ///< fit a named view so that the box fits from all sides, for turntables
    double zoom = 1.0;                      ///< magnification from the same eye, in [0.05, 50]; narrows the fov
    double margin = 0.08;  ///< share of the frame left free on each side of a fitted view, in [0, 0.45]

    /// Throws UsageError.
    void validate() const;
};

/// A pinhole or a thin lens. Pixels are square; (0, 0) is the upper left corner of the frame, (width, height) the lower
/// right one. Immutable.
class Camera {
public:
    /// World space; `up` of any length.
    /// @param fov            degrees, vertical, whole angle
    /// @param width, height  pixels of the whole frame
    /// Throws UsageError if eye and look_at coincide or `up` is parallel to the line between them.
    Camera(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double fov, int width, int height);

    /// The camera of `options` for this box. A named view is as close as possible with all points of `outline` inside
    /// the frame without its margin, and centered.
    /// @param outline  points whose convex hull holds what is seen; none: the corners of the box
    /// Throws UsageError.
    static Camera make(const CameraOptions& options, const trace::Box& box, int width, int height,
                       std::span<const glm::dvec3> outline = {});

    /// The ray through a point of the frame, in pixels.
    trace::Ray ray(const glm::dvec2& pixel) const {
        const double scale = pixelSize();
        const double x = (pixel.x - 0.5 * width_) * scale;
        const double y = (0.5 * height_ - pixel.y) * scale;
        trace::Ray ray;
        ray.origin = eye_;
        ray.direction = glm::normalize(forward_ + x * right_ + y * up_);
        return ray;
    }
    /// Whether the camera has a lens, i.e. depth of field.
    bool hasLens() const { return lens_radius_ > 0.0; }
    /// The ray through a point of the frame and a point of the lens.
    /// @param u  uniform in [0, 1)^2
    trace::Ray ray(const glm::dvec2& pixel, const glm::vec2& u) const;
    /// The same camera with a lens. World units; focus is along forward(), > 0.
    Camera withLens(double radius, double focus) const;
    /// The same camera with a longer (factor above 1) or shorter focal length: magnified about the middle.
    Camera zoomed(double factor) const;
    /// The same camera rotated about a vertical axis, counter-clockwise as seen from above.
    Camera turned(double degrees, const glm::dvec3& about) const;
    /// Projects a world-space point, in pixels; nothing if it is not in front of the camera.
    std::optional<glm::dvec2> project(const glm::dvec3& point) const;

    const glm::dvec3& eye() const { return eye_; }
    /// Unit axes, world space.
    const glm::dvec3& right() const { return right_; }
    const glm::dvec3& up() const { return up_; }
    const glm::dvec3& forward() const { return forward_; }
    /// The side of a pixel on a plane at distance 1.
    double pixelSize() const { return 2.0 * tan_half_ / height_; }
    int width() const { return width_; }
    int height() const { return height_; }
    double fov() const { return fov_; }

private:
    static Camera fitted(const CameraOptions& options, const trace::Box& box, std::span<const glm::dvec3> outline,
                         int width, int height);
    void fit(const glm::dvec3& middle, const std::vector<glm::dvec3>& points, double margin);

    glm::dvec3 eye_, right_, up_, forward_;
    double fov_;       // degrees
    double tan_half_;  // of the vertical angle
    int width_, height_;
    double lens_radius_ = 0.0, focus_ = 1.0;  // world units
};

}  // namespace stratum::shade
