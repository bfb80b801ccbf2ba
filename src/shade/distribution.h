// Drawing from a table: piecewise-constant densities on the unit square and on the sphere.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <functional>
#include <vector>

namespace stratum::shade {

/// A density on [0, 1)^2 that is constant in each of columns x rows cells.
/// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., A.5.
class Distribution2D {
public:
    /// @param weights  columns * rows values, row by row, >= 0 and finite. All zero means uniform.
    Distribution2D(const std::vector<double>& weights, int columns, int rows);

    /// @param u    uniform in [0, 1)^2
    /// @param pdf  density there, per unit of area
    glm::dvec2 sample(const glm::dvec2& u, double& pdf) const;
    double pdf(const glm::dvec2& point) const;

private:
    int columns_, rows_;
    std::vector<double> column_cdf_;  // per row: columns + 1 values from 0 to 1
    std::vector<double> row_cdf_;     // rows + 1 values from 0 to 1
    std::vector<double> density_;
};

/// A density on the sphere from a latitude-longitude table: u is the azimuth about +z from +x, v the polar angle from
/// +z, both over their whole range.
class SphereDistribution {
public:
    /// Tabulates `weight(direction)`, averaged over each cell.
    SphereDistribution(const std::function<double(const glm::dvec3&)>& weight, int columns, int rows);

    /// @param pdf  per steradian; 0 means "no sample" (a pole)
    glm::vec3 sample(const glm::vec2& u, float& pdf) const;
    float pdf(const glm::vec3& direction) const;

private:
    Distribution2D table_;
};

}  // namespace stratum::shade
