#include "shade/integrator/random_walk.h"

#include "shade/analytic_prints.h"
#include "shade/environment/environment.h"
#include "shade/integrator/path.h"
#include "shade/mean_radiance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

using shade::Color;
using shade::Medium;
using shade::Translucent;

/// 0 <= z <= depth, without sides.
test::FunctionIntersector slab(double depth) {
    constexpr double kWide = 1e6;
    return {{{-kWide, -kWide, 0.0}, {kWide, kWide, depth}}, 1e-7, [depth](const trace::Ray& ray, trace::Hit& hit) {
                bool found = false;
                for (const double z : {0.0, depth}) {
                    const double t = (z - ray.origin.z) / ray.direction.z;
                    if (!(t >= ray.t_min && t <= ray.t_max) || (found && t >= hit.t)) continue;
                    hit.t = t;
                    hit.position = ray.origin + t * ray.direction;
                    hit.position.z = z;
                    hit.normal = {0.0, 0.0, z > 0.0 ? 1.0 : -1.0};
                    found = true;
                }
                return found;
            }};
}

struct Shares {
    double reflected = 0, transmitted = 0;
};

/// What comes out of a slab without a surface, of light that falls in vertically.
Shares throughSlab(const Medium& medium, double depth, int count) {
    const auto print = slab(depth);
    const Translucent solid(medium, Color(0.5f), std::make_shared<shade::RoughInterface>(1.465f, 0.2f));
    shade::SceneDescription scene = test::plainScene(print, "natural-pla", "constant:1,1,1", false);
    const shade::Surfaces surfaces(scene, print);
    const shade::RandomWalk walk(surfaces, print.bounds(), 1.0);
    const auto tracer = print.makeTracer();
    shade::RayCounts rays;
    Shares out;
    constexpr int kBatch = 4096;
    std::vector<shade::Walker> walkers;
    std::vector<shade::Arrival> arrivals;
    for (int first = 0; first < count; first += kBatch) {
        std::vector<shade::Sampler> samplers(kBatch, shade::Sampler(9, 65536));
        for (int n = 0; n < kBatch; ++n) {
            samplers[static_cast<std::size_t>(n)].start((first + n) >> 16, 0,
                                                        static_cast<std::uint32_t>(first + n) & 0xffffu);
            shade::Walker walker;
            walker.ray.origin = {0.0, 0.0, depth * (1.0 - 1e-12)};
            walker.ray.direction = {0.0, 0.0, -1.0};
            walker.solid = &solid;
            walker.pixel = static_cast<std::size_t>(n);
            walkers.push_back(walker);
        }
        walk.walk(walkers, samplers, *tracer, rays, arrivals);
        for (const shade::Arrival& arrival : arrivals)
            (arrival.point.position.z > 0.5 * depth ? out.reflected : out.transmitted) +=
                static_cast<double>(arrival.walker.throughput.r) / count;
    }
    return out;
}

constexpr int kWalkers = 1 << 20;

TEST(RandomWalk, AbsorptionAloneIsBeersLaw) {
    for (const double depth : {0.1, 1.0, 3.0}) {
        const Shares s = throughSlab({Color(0.0f), 1.25, 0.0f}, depth, kWalkers);
        EXPECT_NEAR(s.transmitted, std::exp(-depth / 1.25), 0.005 * std::exp(-depth / 1.25));
        EXPECT_EQ(s.reflected, 0.0);
    }
}

TEST(RandomWalk, DeepLightFallsToATenthInTheTransmissionDistance) {
    const float albedo = shade::scatteringAlbedo(Color(0.4f), 0.0f).r;
    const Medium medium{Color(albedo), shade::meanFreePathOf(1.0, static_cast<double>(albedo)), 0.0f};
    const double thin = throughSlab(medium, 1.5, kWalkers).transmitted;
    const double thick = throughSlab(medium, 2.0, kWalkers).transmitted;
    EXPECT_NEAR(thick / thin, std::pow(10.0, -0.5), 0.02 * std::pow(10.0, -0.5));
    // Without scattering it is Beer's law; what absorbs nothing lets all through, whatever its free path.
    EXPECT_NEAR(shade::meanFreePathOf(1.0, 0.0), 1.0 / std::log(10.0), 1e-12);
    EXPECT_NEAR(shade::meanFreePathOf(1.0, 1.0), 0.0, 1e-6);
}

TEST(RandomWalk, ASlabScattersAsInVanDeHulstsTable) {
    // H. C. van de Hulst, "Multiple Light Scattering", 1980, as quoted by L. Wang, S. Jacques, L. Zheng, "MCML",
    // Computer Methods and Programs in Biomedicine 47, 1995, table 1: absorption 10 / cm, scattering 90 / cm, g 0.75,
    // 0.2 mm thick, the same index in and out.
    const Shares s = throughSlab({Color(0.9f), 0.1, 0.75f}, 0.2, kWalkers);
    EXPECT_NEAR(s.reflected, 0.09739, 0.01 * 0.09739);
    EXPECT_NEAR(s.transmitted, 0.66096, 0.01 * 0.66096);
}

TEST(RandomWalk, NothingIsLostWithoutAbsorption) {
    for (const float g : {-0.5f, 0.0f, 0.9f}) {
        const Shares s = throughSlab({Color(1.0f), 0.3, g}, 2.0, 1 << 14);
        EXPECT_NEAR(s.reflected + s.transmitted, 1.0, 1e-6) << g;
        EXPECT_GT(s.transmitted, 0.05);
    }
}

TEST(RandomWalk, DirectionsHaveTheMeanCosineAskedFor) {
    constexpr int kSide = 512;
    const glm::dvec3 before = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    for (const float g : {-0.9f, -0.3f, 0.0f, 0.0005f, 0.75f}) {
        glm::dvec3 mean(0.0);
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j)
                mean += shade::scatteredDirection(before, g, {(i + 0.5f) / kSide, (j + 0.5f) / kSide}) /
                        double(kSide * kSide);
        EXPECT_NEAR(glm::length(mean - static_cast<double>(g) * before), 0.0, 2e-3) << g;
    }
}

/// Mean radiance along a vertical ray on a slab, in light from everywhere.
double seenOnSlab(const Medium& medium, double depth, float eta, std::uint32_t samples) {
    const auto print = slab(depth);
    shade::SceneDescription scene = test::plainScene(print, "natural-pla", "constant:1,1,1", false);
    scene.material =
        std::make_shared<Translucent>(medium, Color(0.5f), std::make_shared<shade::RoughInterface>(eta, 0.001f));
    scene.backdrop.reset();
    trace::Ray ray;
    ray.origin = {0.0, 0.0, depth + 1.0};
    ray.direction = {0.0, 0.0, -1.0};
    return static_cast<double>(test::meanRadiance(print, shade::PathIntegrator(scene, print, 3), ray, samples).r);
}

TEST(RandomWalk, AHalfSpaceOfGlassScattersAsInGiovanellisTable) {
    // R. Giovanelli, "Reflection by semi-infinite diffusers", Optica Acta 2, 1955, as quoted in the paper on MCML,
    // table 2: index 1.5, absorption 10 / cm, scattering 90 / cm, isotropic; the reflection at the surface is included.
    // Light from everywhere seen along one ray is what that ray's light would scatter to everywhere.
    EXPECT_NEAR(seenOnSlab({Color(0.9f), 0.1, 0.0f}, 10.0, 1.5f, 1u << 18), 0.26, 0.01 * 0.26);
}

TEST(RandomWalk, AnAbsorbingPaneReflectsAndTransmitsByTheirSeries) {
    const double f = static_cast<double>(shade::fresnelDielectric(1.0f, 1.465f));
    for (const double depth : {0.2, 1.0}) {
        const double inside = std::exp(-depth);
        const double transmitted = (1 - f) * (1 - f) * inside / (1 - f * f * inside * inside);
        const double reflected = f + f * (1 - f) * (1 - f) * inside * inside / (1 - f * f * inside * inside);
        EXPECT_NEAR(seenOnSlab({Color(0.0f), 1.0, 0.0f}, depth, 1.465f, 1u << 16), transmitted + reflected,
                    0.005 * (transmitted + reflected));
    }
}

TEST(RandomWalk, AWhiteBodyInAWhiteFurnaceCannotBeSeen) {
    const auto ball = test::sphere({0, 0, 0}, 3.0);
    // A thin shell, inner side included: light goes in and out of plastic many times.
    const auto inner = test::sphere({0, 0, 0}, 2.2);
    const test::FunctionIntersector shell(ball.bounds(), 1e-6, [&](const trace::Ray& ray, trace::Hit& hit) {
        const auto outside = ball.makeTracer();
        const auto inside = inner.makeTracer();
        trace::Hit other;
        const bool far = outside->intersect(ray, hit);
        if (!inside->intersect(ray, other) || (far && hit.t < other.t)) return far;
        hit = other;
        hit.normal = -other.normal;
        return true;
    });
    // Paths end at random places, so that one sample is far from the mean: the test is of the mean of all.
    glm::dvec3 mean(0.0);
    std::uint32_t seed = 0;
    for (const trace::Intersector* shape :
         {static_cast<const trace::Intersector*>(&ball), static_cast<const trace::Intersector*>(&shell)}) {
        const shade::SceneDescription scene =
            test::plainScene(*shape, "translucent:1,1,1,1.5", "constant:1,1,1", false);
        for (const double y : {0.0, 2.0, 2.9}) {
            trace::Ray ray;
            ray.origin = {30.0, y, 0.0};
            ray.direction = {-1.0, 0.0, 0.0};
            const Color c = test::meanRadiance(*shape, shade::PathIntegrator(scene, *shape, 1), ray, 1u << 16, ++seed);
            EXPECT_NEAR(c.r, 1.0f, 0.01f);
            mean += glm::dvec3(c) / 6.0;
        }
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], 1.0, 2e-3);
}

/// A ball whose smooth normals lean to a side, by the angle with this tangent.
class LeaningBall final : public trace::Intersector {
public:
    explicit LeaningBall(double tangent) : tangent_(tangent) {}
    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<Rays>(ball_, tangent_); }
    std::string_view name() const override { return "leaning"; }
    trace::Box bounds() const override { return ball_.bounds(); }
    double voxelSize() const override { return 0.1; }
    std::size_t bytes() const override { return 0; }
    double surfaceOffset() const override { return ball_.surfaceOffset(); }

private:
    struct Rays final : trace::Tracer {
        Rays(const test::FunctionIntersector& ball, double lean) : inner(ball.makeTracer()), tangent(lean) {}
        bool intersect(const trace::Ray& ray, trace::Hit& hit) override { return inner->intersect(ray, hit); }
        bool occluded(const trace::Ray& ray) override { return inner->occluded(ray); }
        glm::dvec3 shadingNormal(const trace::Hit& hit) override {
            // Like the facets of voxels: from place to place to another side.
            const double turn = 40.0 * (hit.position.x + 2.0 * hit.position.y + 3.0 * hit.position.z);
            const glm::dvec3 side(std::cos(turn), std::sin(turn), std::cos(1.7 * turn));
            return glm::normalize(hit.normal + tangent * glm::normalize(side));
        }
        std::unique_ptr<trace::Tracer> inner;
        double tangent;
    };
    const test::FunctionIntersector ball_ = test::sphere({0, 0, 0}, 3.0);
    const double tangent_;
};

// Once, what a leaning normal sent to the wrong side of the real surface was lost.
TEST(RandomWalk, SmoothNormalsLoseNoLight) {
    const LeaningBall ball(0.3);
    shade::SceneDescription scene = test::plainScene(ball, "translucent:1,1,1,1.5", "constant:1,1,1", false);
    scene.smooth_normals = true;
    glm::dvec3 mean(0.0);
    std::uint32_t seed = 0;
    for (const double y : {0.0, 1.5, 2.5, 2.9}) {
        trace::Ray ray;
        ray.origin = {30.0, y, 0.1};
        ray.direction = {-1.0, 0.0, 0.0};
        mean +=
            glm::dvec3(test::meanRadiance(ball, shade::PathIntegrator(scene, ball, 1), ray, 1u << 16, ++seed)) / 4.0;
    }
    EXPECT_NEAR(mean.x, 1.0, 1e-3);
}

TEST(RandomWalk, AThickPieceHasTheColorAskedFor) {
    // Of the light that gets in; what the surface reflects comes on top, and is all of a black piece.
    constexpr double kDeep = 1500.0;
    const auto print = slab(kDeep);
    const auto inDiffuseLight = [&](const char* brdf) {
        shade::SceneDescription scene = test::plainScene(print, brdf, "constant:1,1,1", false);
        scene.backdrop.reset();
        glm::dvec3 seen(0.0);
        constexpr int kAngles = 8;
        for (int n = 0; n < kAngles; ++n) {
            const double cosine = std::sqrt((n + 0.5) / kAngles);
            trace::Ray ray;
            ray.direction = {std::sqrt(1 - cosine * cosine), 0.0, -cosine};
            ray.origin = glm::dvec3(0.0, 0.0, kDeep) - 5.0 * ray.direction;
            seen += glm::dvec3(test::meanRadiance(print, shade::PathIntegrator(scene, print, 1), ray, 1u << 11)) /
                    static_cast<double>(kAngles);
        }
        return seen;
    };
    const glm::dvec3 black = inDiffuseLight("translucent:0,0,0,1");
    for (const auto& [brdf, tolerance] :
         {std::pair{"translucent:0.9,0.5,0.1,1", 0.02}, std::pair{"translucent:0.9,0.5,0.1,1,0.8", 0.04}}) {
        const glm::dvec3 body = (inDiffuseLight(brdf) - black) / (1.0 - black);
        EXPECT_NEAR(body.r, 0.9, tolerance) << brdf;
        EXPECT_NEAR(body.g, 0.5, tolerance) << brdf;
        EXPECT_NEAR(body.b, 0.1, tolerance) << brdf;
    }
}

TEST(RandomWalk, AStreamAnswersAsItsRaysDoOneByOne) {
    const auto ball = test::sphere({0, 0, 3}, 3.0);
    const shade::SceneDescription scene = test::plainScene(ball, "translucent:0.9,0.8,0.6,0.8", "sky", true);
    const shade::PathIntegrator integrator(scene, ball, 3);
    const auto tracer = ball.makeTracer();
    constexpr std::size_t kRays = 300;
    std::vector<trace::Ray> rays(kRays);
    std::vector<shade::Sampler> samplers(kRays, shade::Sampler(4, 16));
    for (std::size_t n = 0; n < kRays; ++n) {
        rays[n].origin = {20.0, -8.0 + 0.05 * static_cast<double>(n), 4.0};
        rays[n].direction = {-1.0, 0.0, 0.0};
        samplers[n].start(static_cast<int>(n), 7, 3);
    }
    std::vector<shade::Sampler> again = samplers;
    std::vector<shade::SurfacePoint> points(kRays);
    std::vector<shade::Pixel> pixels(kRays);
    shade::RayCounts counts;
    integrator.radianceStream(rays, samplers, *tracer, counts, points, pixels);
    for (std::size_t n = 0; n < kRays; ++n) {
        shade::RayCounts alone;
        shade::TraceContext context{*tracer, again[n], alone};
        ASSERT_EQ(pixels[n].rgb, test::radianceOf(integrator, rays[n], context).rgb) << n;
    }
}

}  // namespace
}  // namespace stratum
