#include "shade/integrator/pixel_sums.h"

#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace stratum {
namespace {

using shade::Pixel;
using shade::PixelSums;

constexpr const char* kLayers = "normal,layer,variance,samples";

struct Sample {
    Pixel pixel;
    shade::SurfacePoint point;
};

// Values as different as light can be: a sum of doubles would depend on their order. Some hit nothing, the second hit
// is the first that has a number of a layer.
std::vector<Sample> samples() {
    std::vector<Sample> all;
    for (int n = 0; n < 7; ++n) {
        Sample sample;
        const float v = std::ldexp(1.0f / 3.0f, 25 * (n % 5) - 60);
        sample.pixel = {shade::Color(v, 1.0f - v, 1e4f * v), 0.1f * static_cast<float>(n)};
        sample.point.t = n % 3 == 1 ? std::numeric_limits<double>::infinity() : 2.0;
        sample.point.normal = {std::sin(n), 1e-9 * n, std::cos(n)};
        sample.point.labels[static_cast<std::size_t>(shade::Label::layer)] = n < 2 ? -1.0f : static_cast<float>(10 + n);
        all.push_back(sample);
    }
    return all;
}

shade::Film filmOf(const PixelSums& sums, int count) {
    shade::Film film(1, 1, {0, 0, 1, 1});
    film.layers() = shade::makeLayers(sums.aovs(), 1);
    sums.store(0, count, film, 0, 0);
    return film;
}

TEST(PixelSums, OfSharesAreThoseOfAll) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = shade::makeScene({}, ball, 20, 20);
    const shade::AovRecorder recorder(scene, ball, shade::parseAovs(kLayers));
    const std::vector<Sample> all = samples();
    const auto sumsOf = [&](std::size_t first, std::size_t end) {
        PixelSums sums(1, recorder.aovs());
        for (std::size_t n = first; n < end; ++n)
            sums.add(0, all[n].pixel, recorder, all[n].point, glm::dvec3(0.0, 0.0, -1.0));
        return sums;
    };
    const shade::Film whole = filmOf(sumsOf(0, 7), 7);
    EXPECT_EQ(whole.layers()[1].values[0], 12.0f);
    EXPECT_EQ(whole.layers()[3].values[0], 7.0f);
    for (const std::size_t shares : {1, 2, 7}) {
        PixelSums sums(3, recorder.aovs());
        for (std::size_t n = 0; n < shares; ++n) sums.add(0, sumsOf(7 * n / shares, 7 * (n + 1) / shares), 0);
        const shade::Film film = filmOf(sums, 7);
        EXPECT_EQ(film.pixels()[0].rgb, whole.pixels()[0].rgb) << shares;
        EXPECT_EQ(film.pixels()[0].alpha, whole.pixels()[0].alpha);
        for (std::size_t k = 0; k < whole.layers().size(); ++k)
            EXPECT_EQ(film.layers()[k].values, whole.layers()[k].values) << shares << " " << k;
    }
}

TEST(PixelSums, MeanAndVariance) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = shade::makeScene({}, ball, 20, 20);
    const shade::AovRecorder recorder(scene, ball, {});
    PixelSums sums(2, {});
    for (const float v : {1.0f, 2.0f, 3.0f, 6.0f})
        sums.add(1, {shade::Color(v), 1.0f}, recorder, shade::SurfacePoint(), glm::dvec3(0.0, 0.0, -1.0));
    EXPECT_NEAR(sums.luminance(1, 4), 3.0, 1e-6);
    EXPECT_NEAR(sums.variance(1, 4), (12.5 - 9.0) / 3.0, 1e-6);
    EXPECT_EQ(sums.luminance(0, 4), 0.0);
}

}  // namespace
}  // namespace stratum
