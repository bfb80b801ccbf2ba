// The path integrator against the rendering equation written down as it stands: recursion, directions uniform over the
// hemisphere, no sampling of lights, no weights, one ray at a time.
#include "shade/analytic_prints.h"
#include "shade/environment/environment.h"
#include "shade/integrator/path.h"
#include "shade/light/light.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace stratum {
namespace {

using shade::Color;

/// A rectangular lamp with an intersection of its own.
struct Panel {
    glm::dvec3 center, u, v;  // half edges, perpendicular
    Color radiance;

    /// World units along the ray; infinite if it misses.
    double intersect(const trace::Ray& ray) const {
        const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
        const double t = glm::dot(center - ray.origin, normal) / glm::dot(ray.direction, normal);
        const glm::dvec3 p = ray.origin + t * ray.direction - center;
        const bool inside =
            t > 0.0 && std::abs(glm::dot(p, u)) <= glm::dot(u, u) && std::abs(glm::dot(p, v)) <= glm::dot(v, v);
        return inside ? t : std::numeric_limits<double>::infinity();
    }
};

class Recursion {
public:
    Recursion(const shade::SceneDescription& scene, const trace::Intersector& print, int bounces, const Panel* panel)
        : scene_(scene), surfaces_(scene, print), tracer_(print.makeTracer()), bounces_(bounces), panel_(panel) {}

    /// One estimate of the radiance that comes back along a ray that meets a surface.
    glm::dvec3 estimate(const trace::Ray& ray) {
        shade::SurfacePoint point;
        if (!surfaces_.nearest(ray, *tracer_, point)) throw std::logic_error("the view shows nothing");
        return scattered(point, ray.direction, 1);
    }

private:
    glm::dvec3 scattered(const shade::SurfacePoint& point, const glm::dvec3& towards, int depth) {
        const shade::Frame frame{glm::vec3(point.normal)};
        const double z = uniform_(random_);
        const double angle = 2.0 * std::numbers::pi * uniform_(random_);
        const double r = std::sqrt(1.0 - z * z);
        const glm::vec3 wi(r * std::cos(angle), r * std::sin(angle), z);
        const glm::vec3 wo = frame.toLocal(glm::vec3(-towards));
        // f cos over the density of the hemisphere.
        const glm::dvec3 weight = glm::dvec3(point.brdf->eval(wo, wi)) * z * 2.0 * std::numbers::pi;
        const trace::Ray ray = surfaces_.leave(point, frame.toWorld(wi));
        glm::dvec3 incoming = depth == 1 ? glm::dvec3(scene_.ambient) : glm::dvec3(0.0);
        shade::SurfacePoint next;
        const bool meets = surfaces_.nearest(ray, *tracer_, next);
        // Lamps give light and stand in no one's way.
        const double lamp = panel_ == nullptr ? std::numeric_limits<double>::infinity() : panel_->intersect(ray);
        if (std::isfinite(lamp) && (!meets || lamp < next.t)) incoming += glm::dvec3(panel_->radiance);
        if (!meets)
            incoming += glm::dvec3(scene_.environment->radiance(glm::vec3(ray.direction)));
        else if (depth < bounces_)
            incoming += scattered(next, ray.direction, depth + 1);
        return weight * incoming;
    }

    const shade::SceneDescription& scene_;
    shade::Surfaces surfaces_;
    std::unique_ptr<trace::Tracer> tracer_;
    int bounces_;
    const Panel* panel_;
    std::mt19937_64 random_{17};
    std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// Balls that touch, so that light goes from one to the other.
test::FunctionIntersector threeBalls() {
    std::vector<std::shared_ptr<trace::Tracer>> balls;
    static const std::vector<test::FunctionIntersector> kShapes = {
        test::sphere({0, 0, 2}, 2.0), test::sphere({3.5, 0, 1.5}, 1.5), test::sphere({1.5, 2.5, 1}, 1.0)};
    for (const auto& shape : kShapes) balls.push_back(shape.makeTracer());
    return {{{-2, -2, 0}, {5, 3.5, 4}}, 1e-6, [balls](const trace::Ray& ray, trace::Hit& hit) {
                trace::Ray rest = ray;
                bool any = false;
                for (const auto& ball : balls)
                    if (ball->intersect(rest, hit)) {
                        any = true;
                        rest.t_max = hit.t;
                    }
                return any;
            }};
}

struct RecursionCase {
    std::string name, brdf, environment;
    bool bed, lamp;
    float ambient;
    int bounces;
};

class PathRecursive : public testing::TestWithParam<RecursionCase> {};

// Within 4.5 standard errors of the recursion's own mean, and within its 5 %, wherever it is looked.
TEST_P(PathRecursive, HasTheSameMean) {
    const auto print = threeBalls();
    const RecursionCase& c = GetParam();
    auto scene = test::plainScene(print, c.brdf.c_str(), c.environment.c_str(), c.bed);
    scene.backdrop.reset();
    scene.ambient = Color(c.ambient);
    const Panel panel{{3, -4, 7}, {3, 0, 0}, {0, 2, 0}, Color(4.0f, 3.0f, 2.0f)};
    if (c.lamp)
        scene.lights.push_back(std::make_shared<shade::RectangleLight>(panel.center, panel.u, panel.v, panel.radiance));
    const shade::PathIntegrator path(scene, print, c.bounces);
    Recursion recursion(scene, print, c.bounces, c.lamp ? &panel : nullptr);
    // The crease between two balls, the lit side of one, the bed beside it.
    std::vector<std::pair<glm::dvec3, glm::dvec3>> views = {{{2, -20, 8}, {1.75, -0.5, 1.75}},
                                                            {{8, -9, 14}, {0, 0, 3}}};
    if (c.bed) views.push_back({{2, -20, 8}, {1.5, -1.5, -0.01}});
    for (const auto& [from, to] : views) {
        trace::Ray ray;
        ray.origin = from;
        ray.direction = glm::normalize(to - from);
        constexpr int kSamples = 60000;
        glm::dvec3 sum(0.0);
        glm::dvec3 squares(0.0);
        for (int n = 0; n < kSamples; ++n) {
            const glm::dvec3 x = recursion.estimate(ray);
            sum += x;
            squares += x * x;
        }
        const Color found = test::meanRadiance(print, path, ray, 8192);
        for (int k = 0; k < 3; ++k) {
            const double mean = sum[k] / kSamples;
            const double error = std::sqrt((squares[k] / kSamples - mean * mean) / kSamples);
            EXPECT_GT(mean, 0.0);
            EXPECT_LT(error, 0.015 * mean) << "too few samples to say anything";
            EXPECT_NEAR(found[k], mean, 4.5 * error) << "from " << from.z << ", channel " << k;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PathRecursive,
    testing::Values(RecursionCase{"matt", "lambert:0.8,0.5,0.2", "constant:1,0.8,0.6", false, false, 0, 3},
                    RecursionCase{"direct", "plastic:0.6,0.3,0.1,0.3", "studio", true, false, 0, 1},
                    RecursionCase{"bed_and_studio", "plastic:0.6,0.3,0.1,0.3", "studio", true, false, 0, 3},
                    RecursionCase{"lamp", "plastic:0.6,0.3,0.1,0.4", "constant:0.2,0.2,0.2", true, true, 0, 3},
                    RecursionCase{"ambient_and_lamp", "lambert:0.8,0.5,0.2", "constant:0.2,0.2,0.2", false, true, 0.3f,
                                  2}),
    [](const testing::TestParamInfo<RecursionCase>& p) { return p.param.name; });

}  // namespace
}  // namespace stratum
