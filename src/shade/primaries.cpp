#include "shade/primaries.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <cmath>

namespace stratum::shade {
namespace {

glm::dvec3 xyzOf(const glm::dvec2& at) { return {at.x / at.y, 1.0, (1.0 - at.x - at.y) / at.y}; }

// SMPTE RP 177: the primaries, each so strong that their sum is the white.
glm::dmat3 toXyz(const Primaries& from) {
    const glm::dmat3 directions(xyzOf(from.red), xyzOf(from.green), xyzOf(from.blue));
    const glm::dvec3 strengths = glm::inverse(directions) * xyzOf(from.white);
    return {directions[0] * strengths[0], directions[1] * strengths[1], directions[2] * strengths[2]};
}

glm::dmat3 adaptation(const glm::dvec2& from, const glm::dvec2& to) {
    const glm::dmat3 cones(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);  // by columns
    const glm::dvec3 scale = (cones * xyzOf(to)) / (cones * xyzOf(from));
    const glm::dmat3 scaled(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z);
    return glm::inverse(cones) * scaled * cones;
}

bool isNear(const glm::dvec2& a, const glm::dvec2& b) {
    return glm::all(glm::lessThan(glm::abs(a - b), glm::dvec2(0.001)));
}

}  // namespace

std::optional<glm::dmat3> toRec709(const Primaries& from) {
    const Primaries to;
    if (isNear(from.red, to.red) && isNear(from.green, to.green) && isNear(from.blue, to.blue) &&
        isNear(from.white, to.white))
        return std::nullopt;
    const glm::dmat3 matrix = glm::inverse(toXyz(to)) * adaptation(from.white, to.white) * toXyz(from);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(matrix[column][row]) < 100.0)) return std::nullopt;
    return matrix;
}

void convert(std::span<Color> colors, const glm::dmat3& to_rec709) {
    for (Color& color : colors) color = glm::max(Color(to_rec709 * glm::dvec3(color)), Color(0.0f));
}

}  // namespace stratum::shade
