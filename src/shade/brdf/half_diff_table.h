// A BRDF as a table over half and difference angles.
#pragma once

#include "shade/color.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace stratum::shade {

/// 90 x 90 x 180 cells over the half vector's angle to the normal (square-root warped: the highlight gets most cells),
/// the difference angle, and the rotation of the difference about the half vector over [0, pi): the other half is the
/// same by reciprocity, so that lookups are reciprocal by construction. Values are at the centers of cells and are
/// interpolated linearly.
/// Sources: S. Rusinkiewicz, "A New Change of Variables for Efficient BRDF Representation", EGRW 1998; the layout is
/// that of W. Matusik et al., "A Data-Driven Reflectance Model", SIGGRAPH 2003 (the MERL database).
class HalfDiffTable {
public:
    static constexpr int kHalf = 90;
    static constexpr int kDiff = 90;
    static constexpr int kTurn = 180;
    static constexpr std::size_t kCells = std::size_t{kHalf} * kDiff * kTurn;

    /// @param values  kCells, 1/sr, finite, >= 0: rotation fastest, then difference, then half angle
    explicit HalfDiffTable(std::vector<Color> values) : values_(std::move(values)) {}

    /// Bakes a reciprocal, isotropic function of unit vectors towards light and viewer that is its own mirror image
    /// (half of the cells are filled by that symmetry), on all threads. It is also called for pairs with a direction
    /// below the horizon, z <= 0, where it should return about the value of the nearest direction above.
    static HalfDiffTable bake(const std::function<glm::dvec3(const glm::dvec3&, const glm::dvec3&)>& brdf);

    /// 1/sr; both unit and above the horizon.
    Color at(const glm::vec3& wo, const glm::vec3& wi) const;
    /// The same of many pairs, in vectors: the cache misses of many lookups are served together. Arctangents are
    /// polynomials, so values differ by up to 2e-5 of themselves. Reciprocal to the bit, and the same bits on every
    /// processor.
    /// @param wi, values  as many as wo
    void at(std::span<const glm::vec3> wo, std::span<const glm::vec3> wi, std::span<Color> values) const;
    const std::vector<Color>& values() const { return values_; }

    /// Unit vectors of the middle of a cell.
    static void directionsOf(int half, int diff, int turn, glm::dvec3& wo, glm::dvec3& wi);

private:
    std::vector<Color> values_;
};

}  // namespace stratum::shade
