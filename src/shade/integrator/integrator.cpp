#include "shade/integrator/integrator.h"

#include "base/error.h"
#include "base/names.h"
#include "shade/integrator/ambient_occlusion.h"
#include "shade/integrator/geometry_integrators.h"
#include "shade/integrator/path.h"
#include "shade/integrator/phong.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

namespace stratum::shade {

void IntegratorOptions::validate() const {
    if (std::find(kIntegratorNames.begin(), kIntegratorNames.end(), name) == kIntegratorNames.end())
        throw UsageError(fmt::format("--integrator {}: unknown; choose {}{}", name, fmt::join(kIntegratorNames, ", "),
                                     didYouMean(name, kIntegratorNames)));
    if (bounces < 1 || bounces > 64)
        throw UsageError(fmt::format("--bounces {}: must be from 1 (direct light) to 64", bounces));
    const auto within = [](float value, float high) { return value >= 0.0f && value <= high; };
    if (!within(phong.ambient, 100.0f) || !within(phong.diffuse, 100.0f) || !within(phong.specular, 100.0f) ||
        !within(phong.shininess, 1e6f) || !within(phong.reflective, 1.0f))
        throw UsageError(
            "--phong KA,KD,KS,SHININESS,KR: weights from 0 to 100, an exponent to 1e6, a mirror's share to 1");
    if (!(ao_distance > 0.0))
        throw UsageError(fmt::format("the distance of ambient occlusion is {}; it must be above 0", ao_distance));
}

bool needsLight(const IntegratorOptions& options) {
    constexpr std::array<std::string_view, 8> kGeometry = {"ao",   "normal", "depth", "position",
                                                           "mask", "layer",  "tool",  "feature"};
    return std::find(kGeometry.begin(), kGeometry.end(), options.name) == kGeometry.end();
}

bool followsPaths(const IntegratorOptions& options) { return options.name == "path" || options.name == "direct"; }

int bouncesOf(const IntegratorOptions& options) { return options.name == "direct" ? 1 : options.bounces; }

void Integrator::radianceStream(std::span<trace::Ray> rays, std::span<Sampler> samplers, trace::Tracer& tracer,
                                RayCounts& counts, std::span<SurfacePoint> points, std::span<Pixel> pixels) const {
    counts.primary += rays.size();
    surfaces_.nearest(rays, tracer, points);
    seenStream(rays, points, samplers, tracer, counts, pixels);
}

void RayIntegrator::seenStream(std::span<const trace::Ray> rays, std::span<const SurfacePoint> points,
                               std::span<Sampler> samplers, trace::Tracer& tracer, RayCounts& counts,
                               std::span<Pixel> pixels) const {
    for (std::size_t n = 0; n < rays.size(); ++n) {
        TraceContext context{tracer, samplers[n], counts};
        pixels[n] = seen(rays[n], std::isfinite(points[n].t) ? &points[n] : nullptr, context);
    }
}

std::unique_ptr<Integrator> makeIntegrator(const IntegratorOptions& options, const SceneDescription& scene,
                                           const trace::Intersector& print) {
    options.validate();
    if (options.name == "ao") return std::make_unique<AmbientOcclusion>(scene, print, options.ao_distance);
    if (options.name == "normal") return std::make_unique<NormalIntegrator>(scene, print);
    if (options.name == "depth") return std::make_unique<DepthIntegrator>(scene, print);
    if (options.name == "position") return std::make_unique<PositionIntegrator>(scene, print);
    if (options.name == "mask") return std::make_unique<MaskIntegrator>(scene, print);
    if (options.name == "layer" || options.name == "tool" || options.name == "feature")
        return std::make_unique<LabelIntegrator>(scene, print, parseLabel(options.name));
    if (options.name == "phong") return std::make_unique<PhongIntegrator>(scene, print, options.phong);
    return std::make_unique<PathIntegrator>(scene, print, bouncesOf(options), options.radiance_cache.get());
}

}  // namespace stratum::shade
