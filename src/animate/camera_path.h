// A camera that moves: key frames in a file, and the smooth way through them.
//
//     {"keys": [{"time": 0, "eye": [120, -200, 90]},
//               {"time": 3, "eye": [220, -60, 60], "look_at": [100, 100, 10]},
//               {"time": 5, "eye": [150, -50, 200], "fov": 20}]}
#pragma once

#include "shade/camera/camera.h"

#include <glm/vec3.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace stratum::animate {

// A smooth curve through given values that never leaves the range of two neighbours.

/// A cubic Hermite spline with continuous slopes, monotone between values. It passes exactly through all of them; with
/// two it is straight, with one constant. Slopes: F. N. Fritsch, J. Butland, "A Method for Constructing Local Monotone
/// Piecewise Cubic Interpolants", SIAM J. Sci. Stat. Comput. 5 (1984), in the form of Brodlie that weighs by lengths.
class MonotoneCubic {
public:
    /// @param places  ascending, at least one
    /// @param values  as many
    MonotoneCubic(std::vector<double> places, std::vector<double> values);
    /// The first or the last value outside of the places.
    double operator()(double place) const;

private:
    std::vector<double> places_, values_, slopes_;
};

struct CameraKey {
    double time = 0.0;                  ///< seconds
    glm::dvec3 eye{0.0};                ///< world space
    std::optional<glm::dvec3> look_at;  ///< world space; else the middle of the part
    std::optional<glm::dvec3> up;       ///< any length; else +z
    std::optional<double> fov;          ///< degrees, vertical, whole angle; else that of the command line
};

/// At least two keys with ascending times. Throws InputError: place of a syntax error, the path of a value of the wrong
/// kind, an unknown key and the known one that is most like it, what is out of range.
std::vector<CameraKey> readCameraKeys(const std::filesystem::path& path);

/// Seconds from the first key to the last.
double durationOf(const std::vector<CameraKey>& keys);

/// Places the camera of `options` where a key has it; what the key leaves open stays as it is.
void placeAt(const CameraKey& key, shade::CameraOptions& options);

/// The way of eye, look_at, up and fov through all keys, each coordinate by a MonotoneCubic over time: no coordinate
/// leaves the range of the keys beside it, so that a camera whose keys are above the bed stays there.
class CameraPath {
public:
    /// @param middle  for keys without look_at
    /// @param fov     for keys without one
    CameraPath(const std::vector<CameraKey>& keys, const glm::dvec3& middle, double fov);

    /// Places the camera of `options`.
    /// @param share  of the way's duration, in [0, 1]
    void place(double share, shade::CameraOptions& options) const;

private:
    using Way = std::array<MonotoneCubic, 3>;
    static glm::dvec3 at(const Way& way, double time) { return {way[0](time), way[1](time), way[2](time)}; }

    double begin_, duration_;  // seconds
    Way eye_, look_at_, up_;
    MonotoneCubic fov_;
};

}  // namespace stratum::animate
