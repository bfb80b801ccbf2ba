#include "shade/integrator/random_walk.h"

#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <algorithm>
#include <cmath>

namespace stratum::shade {
namespace {

/// Of one walk. A conservative medium of 1000 free paths' thickness needs about its square.
constexpr int kMostEvents = 1 << 20;
/// Paths fainter than this play roulette.
constexpr float kFaint = 0.1f;

bool within(const trace::Box& box, const glm::dvec3& p) {
    return p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z && p.x <= box.max.x && p.y <= box.max.y &&
           p.z <= box.max.z;
}

}  // namespace

glm::dvec3 scatteredDirection(const glm::dvec3& before, float asymmetry, const glm::vec2& u) {
    // For small g the quotient below loses its digits; the limit is even over the sphere.
    float cosine = 1.0f - 2.0f * u.x;
    if (std::abs(asymmetry) > 1e-3f) {
        const float g = asymmetry;
        const float q = (1.0f - g * g) / (1.0f - g + 2.0f * g * (1.0f - u.x));
        cosine = std::clamp((1.0f + g * g - q * q) / (2.0f * g), -1.0f, 1.0f);
    }
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    const float phi = 2.0f * kPi * u.y;
    const Frame frame{glm::vec3(before)};
    return glm::normalize(glm::dvec3(frame.toWorld({sine * std::cos(phi), sine * std::sin(phi), cosine})));
}

bool survives(Color& throughput, Sampler& sampler) {
    const float most = maxComponent(throughput);
    if (most >= kFaint) return true;
    if (!(most > 0.0f) || sampler.next1D() * kFaint >= most) return false;
    throughput *= kFaint / most;
    return true;
}

bool RandomWalk::scatter(Walker& walker, Sampler& sampler) const {
    walker.ray.origin += walker.ray.t_max * walker.ray.direction;
    walker.throughput *= walker.solid->medium().albedo;
    const glm::vec2 u = sampler.next2D();
    if (!survives(walker.throughput, sampler) || !within(bounds_, walker.ray.origin)) return false;
    walker.ray.direction = scatteredDirection(walker.ray.direction, walker.solid->medium().asymmetry, u);
    return true;
}

void RandomWalk::walk(std::vector<Walker>& walkers, std::span<Sampler> samplers, trace::Tracer& tracer,
                      RayCounts& counts, std::vector<Arrival>& arrivals) const {
    arrivals.clear();
    std::vector<trace::Ray> rays;
    std::vector<SurfacePoint> points;
    for (int event = 0; event < kMostEvents && !walkers.empty(); ++event) {
        rays.clear();
        rays.reserve(walkers.size());
        for (Walker& walker : walkers) {
            // 1 - u is never 0.
            const auto u = static_cast<double>(samplers[walker.pixel].next1D());
            walker.ray.t_max = -std::log1p(-u) * walker.solid->medium().mean_free_path / mm_per_unit_;
            rays.push_back(walker.ray);
        }
        points.resize(rays.size());
        counts.bounce += rays.size();
        surfaces_.nearestInside(rays, tracer, points);
        std::size_t kept = 0;
        for (std::size_t n = 0; n < walkers.size(); ++n) {
            if (std::isfinite(points[n].t)) {
                arrivals.push_back({walkers[n], points[n]});
                continue;
            }
            if (scatter(walkers[n], samplers[walkers[n].pixel])) walkers[kept++] = walkers[n];
        }
        walkers.resize(kept);
    }
    walkers.clear();
}

}  // namespace stratum::shade
