// What an integrator sees along one ray, averaged.
#pragma once

#include "shade/integrator/integrator.h"

#include <cstdint>

namespace stratum::test {

/// What an integrator sees along one ray: a stream of one.
inline shade::Pixel radianceOf(const shade::Integrator& integrator, trace::Ray ray, shade::TraceContext& context) {
    shade::SurfacePoint point;
    shade::Pixel pixel;
    integrator.radianceStream({&ray, 1}, {&context.sampler, 1}, context.tracer, context.rays, {&point, 1}, {&pixel, 1});
    return pixel;
}

inline shade::Color meanRadiance(const trace::Intersector& print, const shade::Integrator& integrator,
                                 const trace::Ray& ray, std::uint32_t samples, std::uint32_t seed = 1) {
    const auto tracer = print.makeTracer();
    shade::Sampler sampler(seed, samples);
    shade::RayCounts rays;
    shade::TraceContext context{*tracer, sampler, rays};
    glm::dvec3 sum(0.0);
    for (std::uint32_t s = 0; s < samples; ++s) {
        sampler.start(3, 4, s);
        sum += glm::dvec3(radianceOf(integrator, ray, context).rgb);
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
