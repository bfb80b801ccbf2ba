// A turn and a move.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace stratum::compare {

struct Rigid {
    glm::dmat3 turn{1.0};
    glm::dvec3 move{0.0};  ///< mm

    glm::dvec3 operator()(const glm::dvec3& p) const { return turn * p + move; }
    Rigid inverse() const {
        const glm::dmat3 back = glm::transpose(turn);
        return {back, -(back * move)};
    }
    /// First `first`, then this.
    Rigid after(const Rigid& first) const { return {turn * first.turn, turn * first.move + move}; }
};

/// A turn about an axis through the origin: its direction times the angle in radians.
glm::dmat3 turnBy(const glm::dvec3& axis_times_angle);

/// The angle of a turn, radians in 0..pi.
double angleOf(const glm::dmat3& turn);

}  // namespace stratum::compare
