// What an integrator sees along one ray, averaged.
#pragma once

#include "shade/integrator/integrator.h"

#include <cstdint>

namespace stratum::test {

inline shade::Color meanRadiance(const trace::Intersector& print, const shade::Integrator& integrator,
                                 const trace::Ray& ray, std::uint32_t samples, std::uint32_t seed = 1) {
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(seed, samples);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    glm::dvec3 sum(0.0);
    for (std::uint32_t s = 0; s < samples; ++s) {
        sampler.start(3, 4, s);
        sum += glm::dvec3(integrator.radiance(ray, context).rgb);
    }
    return shade::Color(sum / double(samples));
}

/// A scene of one material under one light, as the tests' options.
inline shade::SceneDescription plainScene(const trace::Intersector& print, const char* brdf, const char* env,
                                          bool bed) {
    shade::SceneOptions options;
    options.brdf = brdf;
    options.env = env;
    options.bed = bed;
    return shade::makeScene(options, print, 32, 24);
}

}  // namespace stratum::test
