// Directions of a latitude-longitude map for many surfaces at once, in vectors.
#pragma once

#include "shade/environment/bilinear_distribution.h"
#include "shade/environment/environment.h"
#include "shade/environment/light_map.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>

namespace stratum::shade {

/// A map with its rotation and tables. Keeps references.
struct PlacedMap {
    const LightMap& map;
    double rotation;                               ///< radians, see MapEnvironment
    std::span<const BilinearDistribution> tables;  ///< one a strategy
};

/// In a large map nearly every sample is a cache miss; in vectors many misses are served together. Angles are computed
/// by polynomials, exact to 3e-8 radians. The same bits on every processor.
///
/// Draws a direction from a table, by the density of all of them together.
/// @param strategy  of the tables
/// @param u         uniform in [0, 1)^2
/// @param normals   of the surfaces, finite, not 0; none if all tables were made without directions
/// @param samples   as many as u
void sampleMap(const PlacedMap& placed, int strategy, std::span<const glm::vec2> u, std::span<const glm::vec3> normals,
               std::span<EnvironmentSample> samples);

/// Radiance and density of directions.
/// @param directions  unit
/// @param normals     as above
/// @param samples     as many as directions
void evalMap(const PlacedMap& placed, std::span<const glm::vec3> directions, std::span<const glm::vec3> normals,
             std::span<EnvironmentSample> samples);

/// Radiance of directions.
/// @param directions  unit
/// @param radiances   as many as directions
void mapRadiance(const PlacedMap& placed, std::span<const glm::vec3> directions, std::span<Color> radiances);

}  // namespace stratum::shade
