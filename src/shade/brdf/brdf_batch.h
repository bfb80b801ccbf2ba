// BRDFs of many vertices at once.
#pragma once

#include "shade/brdf/brdf.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace stratum::shade {

/// Pairs of directions, or draws, at vertices of any materials; neighbours of the same material are one stream of its
/// BRDF. Directions are in the frames of their vertices, see Brdf.
class BrdfBatch {
public:
    std::vector<Color> values;        ///< Brdf::eval of each pair
    std::vector<float> densities;     ///< Brdf::pdf of each pair
    std::vector<BrdfSample> samples;  ///< of each draw; its pdf is 0 where there is none

    const glm::vec3& wi(std::size_t n) const { return wi_[n]; }
    void clear();
    void addPair(const Brdf& brdf, const glm::vec3& wo, const glm::vec3& wi);
    /// @param lobe, u  as for Brdf::sample
    void addDraw(const Brdf& brdf, const glm::vec3& wo, float lobe, const glm::vec2& u);
    /// Sets values and densities. Since clear() only pairs were added.
    void eval();
    /// Sets samples. Since clear() only draws were added.
    void sample();

private:
    /// work(brdf, first, count) for each row of neighbours with the same BRDF.
    void forEachBrdf(const auto& work) const;

    std::vector<const Brdf*> brdfs_;
    std::vector<glm::vec3> wo_, wi_;
    std::vector<float> lobes_;
    std::vector<glm::vec2> u_;
};

}  // namespace stratum::shade
