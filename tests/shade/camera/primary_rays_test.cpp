#include "shade/camera/ray_streams.h"

#include "on_each_target.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace stratum {
namespace {

using shade::Camera;
using shade::Sampler;

class PrimaryRays : public test::OnEachTarget {
protected:
    /// Rays in numbers that fill batches and that don't, over pixels of several blocks, against one ray at a time.
    static void expectOneByOne(const Camera& camera) {
        const shade::PixelFilter filter;
        for (const std::size_t count : {1u, 63u, 64u, 1000u}) {
            std::vector<glm::ivec2> pixels;
            std::vector<Sampler> samplers;
            for (std::size_t n = 0; n < count; ++n) {
                pixels.emplace_back(static_cast<int>(n * 7 % 1921), static_cast<int>(n * 131 % 1083));
                samplers.emplace_back(static_cast<std::uint32_t>(n % 3), 16);
                samplers.back().start(pixels.back().x, pixels.back().y, static_cast<std::uint32_t>(n % 16));
            }
            std::vector<Sampler> alone = samplers;
            std::vector<trace::Ray> rays(count);
            shade::primaryRays(camera, filter, pixels, samplers, rays);
            for (std::size_t n = 0; n < count; ++n) {
                const glm::dvec2 place =
                    glm::dvec2(pixels[n].x + 0.5, pixels[n].y + 0.5) + filter.offset(alone[n].next2D());
                const trace::Ray expected = camera.hasLens() ? camera.ray(place, alone[n].next2D()) : camera.ray(place);
                ASSERT_EQ(std::memcmp(&rays[n].origin, &expected.origin, sizeof expected.origin), 0) << n;
                ASSERT_EQ(std::memcmp(&rays[n].direction, &expected.direction, sizeof expected.direction), 0) << n;
                ASSERT_EQ(rays[n].t_min, expected.t_min);
                ASSERT_EQ(rays[n].t_max, expected.t_max);
                ASSERT_EQ(samplers[n].next1D(), alone[n].next1D()) << "the sampler stands elsewhere";
            }
        }
    }

    const Camera pinhole_{{31.0, -270.5, 99.25}, {-3.0, 4.0, 12.5}, {0.0, 0.0, 1.0}, 28.0, 1920, 1080};
};

INSTANTIATE_TEST_SUITE_P(Targets, PrimaryRays, test::allTargets(), test::targetName);

TEST_P(PrimaryRays, AreTheBitsOfOneByOne) { expectOneByOne(pinhole_); }

TEST_P(PrimaryRays, LeaveFromAllOverALens) { expectOneByOne(pinhole_.withLens(4.0, 250.0)); }

}  // namespace
}  // namespace stratum
