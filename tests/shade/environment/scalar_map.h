// What map_stream.h draws and looks up, one direction at a time in plain loops: the oracle of its tests.
#pragma once

#include "shade/environment/bilinear_distribution.h"
#include "shade/environment/map_stream.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace stratum::test {

/// @param bin  see binOf()
/// @param u    uniform in [0, 1)^2
/// @param pdf  density there per unit of area; 0 means "no sample"
glm::dvec2 drawFrom(const shade::BilinearDistribution& table, int bin, const glm::dvec2& u, double& pdf);
double densityOf(const shade::BilinearDistribution& table, int bin, const glm::dvec2& point);
int binOf(const shade::BilinearDistribution& table, const glm::vec3& normal);

/// The direction of a position on a map; `sine` is that of the polar angle.
glm::vec3 directionOf(const glm::dvec2& uv, double rotation, double& sine);

/// sampleMap() and evalMap() of one surface.
shade::EnvironmentSample sampleOne(const shade::PlacedMap& placed, int strategy, const glm::vec2& u,
                                   const glm::vec3& normal);
shade::EnvironmentSample evalOne(const shade::PlacedMap& placed, const glm::vec3& direction, const glm::vec3& normal);

}  // namespace stratum::test
