#include "shade/integrator/render.h"

#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace stratum {
namespace {

using shade::Pixel;
using shade::PixelSums;

constexpr const char* kLayers = "normal,layer,variance,samples";

struct Samples {
    std::vector<Pixel> pixels;
    std::vector<shade::SurfacePoint> points;
    std::vector<trace::Ray> rays;
};

// Values as different as light can be. Some hit nothing, the second hit is the first that has a number of a layer.
Samples samples() {
    Samples all;
    for (int n = 0; n < 7; ++n) {
        shade::SurfacePoint point;
        const float v = std::ldexp(1.0f / 3.0f, 25 * (n % 5) - 60);
        all.pixels.push_back({shade::Color(v, 1.0f - v, 1e4f * v), 0.1f * static_cast<float>(n)});
        point.t = n % 3 == 1 ? std::numeric_limits<double>::infinity() : 2.0;
        point.normal = {std::sin(n), 1e-9 * n, std::cos(n)};
        point.labels[static_cast<std::size_t>(shade::Label::layer)] = n < 2 ? -1.0f : static_cast<float>(10 + n);
        all.points.push_back(point);
        all.rays.push_back({{0.0, 0.0, 5.0}, {0.0, 0.0, -1.0}});
    }
    return all;
}

shade::Film filmOf(const PixelSums& sums, int count) {
    shade::Film film(1, 1, {0, 0, 1, 1});
    film.layers() = shade::makeLayers(sums.aovs(), 1);
    sums.store(0, count, film, 0, 0);
    return film;
}

TEST(PixelSums, DoNotDependOnHowManyAreAddedAtOnce) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = shade::makeScene({}, ball, 20, 20);
    const shade::AovRecorder recorder(scene, ball, shade::parseAovs(kLayers));
    const Samples all = samples();
    const auto filmOfSums = [&](std::size_t at_once) {
        PixelSums sums(1, recorder.aovs());
        for (std::size_t first = 0; first < 7; first += at_once) {
            const std::size_t count = std::min(at_once, 7 - first);
            sums.add(0, std::span(all.pixels).subspan(first, count), recorder,
                     std::span(all.points).subspan(first, count), std::span(all.rays).subspan(first, count));
        }
        return filmOf(sums, 7);
    };
    const shade::Film whole = filmOfSums(7);
    EXPECT_EQ(whole.layers()[1].values[0], 12.0f);
    EXPECT_EQ(whole.layers()[3].values[0], 7.0f);
    for (const std::size_t at_once : {1, 3}) {
        const shade::Film film = filmOfSums(at_once);
        EXPECT_EQ(film.pixels()[0].rgb, whole.pixels()[0].rgb) << at_once;
        EXPECT_EQ(film.pixels()[0].alpha, whole.pixels()[0].alpha);
        for (std::size_t k = 0; k < whole.layers().size(); ++k)
            EXPECT_EQ(film.layers()[k].values, whole.layers()[k].values) << at_once << " " << k;
    }
}

TEST(PixelSums, MeanAndVariance) {
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    const auto scene = shade::makeScene({}, ball, 20, 20);
    const shade::AovRecorder recorder(scene, ball, {});
    PixelSums sums(2, {});
    std::vector<Pixel> pixels;
    for (const float v : {1.0f, 2.0f, 3.0f, 6.0f}) pixels.push_back({shade::Color(v), 1.0f});
    sums.add(1, pixels, recorder, std::vector<shade::SurfacePoint>(4), std::vector<trace::Ray>(4));
    EXPECT_NEAR(sums.luminance(1, 4), 3.0, 1e-6);
    EXPECT_NEAR(sums.variance(1, 4), (12.5 - 9.0) / 3.0, 1e-6);
    EXPECT_EQ(sums.luminance(0, 4), 0.0);
}

}  // namespace
}  // namespace stratum
