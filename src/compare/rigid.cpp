#include "compare/rigid.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace stratum::compare {

glm::dmat3 turnBy(const glm::dvec3& axis_times_angle) {
    const double angle = glm::length(axis_times_angle);
    if (angle == 0) return glm::dmat3(1.0);
    return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, axis_times_angle / angle));
}

double angleOf(const glm::dmat3& turn) {
    // By both of sine and cosine: each alone is blind somewhere.
    const glm::dvec3 twice_sine(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]);
    return std::atan2(glm::length(twice_sine), turn[0][0] + turn[1][1] + turn[2][2] - 1);
}

}  // namespace stratum::compare
