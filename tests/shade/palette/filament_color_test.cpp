#include "shade/palette/filament_color.h"
#include "shade/finish/named_brdf.h"

#include "base/error.h"
#include "shade/analytic_prints.h"
#include "shade/brdf/brdf.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <string>

namespace stratum {
namespace {

using shade::Color;
using shade::parseNamedColor;

TEST(FilamentColor, ReadsHexAndNames) {
    EXPECT_EQ(shade::hexOf(*parseNamedColor("#ff6600")), "#ff6600");
    EXPECT_EQ(shade::hexOf(*parseNamedColor("#F60")), "#ff6600");
    EXPECT_EQ(shade::hexOf(*parseNamedColor("RebeccaPurple")), "#663399");
    EXPECT_EQ(shade::hexOf(*parseNamedColor("aliceblue")), "#f0f8ff");
    EXPECT_EQ(shade::hexOf(*parseNamedColor("yellowgreen")), "#9acd32");
    for (const char* text : {"", "#", "#12345", "#12345g", "#1234567", "reddish", "ff6600", " red"})
        EXPECT_FALSE(parseNamedColor(text)) << text;
}

TEST(FilamentColor, IsAMaterialAndComesAfterTables) {
    EXPECT_NEAR(shade::reflectanceFactor(*shade::makeBrdf("red")).r, shade::kWhitest, 0.1f);
    EXPECT_NO_THROW(shade::makeBrdf("#00C1AE"));
    EXPECT_NO_THROW(shade::makeBrdf("pla-blue"));
    EXPECT_THROW(shade::makeBrdf("#00C1A"), UsageError);
    EXPECT_THROW(shade::makeBrdf("reddish"), UsageError);
    // Nobody said anything.
    EXPECT_EQ(shade::reflectanceFactor(*shade::makeBrdf("")),
              shade::reflectanceFactor(*shade::makeBrdf(shade::kDefaultBrdf)));
}

TEST(FilamentColor, BodiesStayWithinWhatPlasticsReflect) {
    const Color black = shade::bodyOf(Color(0.0f));
    const Color white = shade::bodyOf(Color(1.0f));
    EXPECT_EQ(black, Color(shade::kBlackest));
    EXPECT_EQ(white, Color(shade::kWhitest));
}

// CIE 1976 L*a*b* under D65 of an encoded sRGB colour from 0 to 1.
std::array<double, 3> labOf(const glm::dvec3& srgb) {
    glm::dvec3 c;
    for (int k = 0; k < 3; ++k) c[k] = srgb[k] <= 0.04045 ? srgb[k] / 12.92 : std::pow((srgb[k] + 0.055) / 1.055, 2.4);
    const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
    const double x = f((0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b) / 0.95047);
    const double y = f(0.2126729 * c.r + 0.7151522 * c.g + 0.0721750 * c.b);
    const double z = f((0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b) / 1.08883);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

// The default picture of a ball of filament: the mean of what looks at the camera, or up, is near the colour that the
// file states.
TEST(FilamentColor, APictureShowsTheColorThatIsStated) {
    const auto ball = test::sphere({0, 0, 10}, 10);
    // Stated colour, and how far the picture may be from it (CIE 1976 difference).
    struct Case {
        const char* text;
        double tolerance;
    };
    for (const Case& c : {Case{"#00C1AE", 12},
                          {"#D8563B", 12},
                          {"#1F4E6B", 12},
                          {"#F2B33D", 12},
                          {"#808080", 12},
                          {"#FFFFFF", 15},
                          {"#000000", 20},
                          // Of these the coat's reflection, which is white, takes more: it is bright beside a channel
                          // that is 0.
                          {"#FF0000", 27},
                          {"#00FF00", 20},
                          {"#0000FF", 28},
                          {"#FF6600", 22},
                          {"#FFFF00", 17},
                          {"#000080", 22}}) {
        shade::SceneOptions options;
        options.brdf = c.text;
        shade::RenderOptions render;
        render.width = 96;
        render.height = 72;
        render.spp = 32;
        const auto scene = shade::makeScene(options, ball, render.width, render.height);
        const auto film = shade::render(ball, scene, render).film;
        const auto rgb = shade::toDisplay(film);
        const auto tracer = ball.makeTracer();
        glm::dvec3 sum(0.0);
        int count = 0;
        for (int y = 0; y < render.height; ++y)
            for (int x = 0; x < render.width; ++x) {
                trace::Hit hit;
                const trace::Ray ray = scene.camera.ray(glm::dvec2(x + 0.5, y + 0.5));
                if (!tracer->intersect(ray, hit)) continue;
                if (glm::dot(hit.normal, ray.direction) > -0.5 || hit.normal.z < 0.0) continue;
                const std::size_t place = 3 * (static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x));
                sum += glm::dvec3(rgb[place], rgb[place + 1], rgb[place + 2]) / 255.0;
                ++count;
            }
        ASSERT_GT(count, 200);
        const Color stated = *parseNamedColor(c.text);
        const auto seen = labOf(sum / double(count));
        const auto wanted =
            labOf({shade::encodeSrgb(stated.r), shade::encodeSrgb(stated.g), shade::encodeSrgb(stated.b)});
        const double difference = std::hypot(seen[0] - wanted[0], seen[1] - wanted[1], seen[2] - wanted[2]);
        RecordProperty(std::string("difference ") + (c.text + 1), std::to_string(difference));
        EXPECT_LT(difference, c.tolerance) << c.text << ": L*a*b* " << seen[0] << " " << seen[1] << " " << seen[2]
                                           << " instead of " << wanted[0] << " " << wanted[1] << " " << wanted[2];
    }
}

}  // namespace
}  // namespace stratum
