#include "shade/scene/material.h"
#include "shade/finish/named_brdf.h"

#include "base/error.h"
#include "refusal.h"
#include "shade/analytic_prints.h"
#include "shade/brdf/lambert.h"
#include "shade/integrator/render.h"
#include "shade/palette/filament_color.h"
#include "shade/scene/scene.h"
#include "shade/scene/surface.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace stratum {
namespace {

using shade::Color;
using shade::makeObjectMaterial;
using shade::MaterialOptions;
using trace::AttributeSummary;

AttributeSummary integers(int least, int most) {
    AttributeSummary summary;
    summary.kind = AttributeSummary::Kind::integer;
    summary.least = least;
    summary.most = most;
    return summary;
}

const char* const kBase = "lambert:0.5,0.5,0.5";

TEST(Material, MaterialsByTool) {
    MaterialOptions options;
    options.by = "tool";
    options.each = {{"0", "lambert:1,0,0"}, {"2", "lambert:0,1,0"}};
    const auto material = makeObjectMaterial(options, kBase, 3, integers(0, 2));
    EXPECT_FALSE(material.single());
    EXPECT_EQ(material.attribute(), 3u);
    const auto albedo = [&](float v) { return material.of(glm::vec3(v, 0, 0)).albedo; };
    EXPECT_NEAR(albedo(0).r, 1, 1e-5f);
    EXPECT_NEAR(albedo(2).g, 1, 1e-5f);
    EXPECT_NEAR(albedo(1).b, 0.5f, 1e-5f);  // no material of its own: the scene's
    EXPECT_NEAR(material.of(std::nullopt).albedo.r, 0.5f, 1e-5f);
}

TEST(Material, KeysMayBeNames) {
    AttributeSummary features = integers(0, 3);
    features.labels = {"unknown", "perimeter", "infill"};
    MaterialOptions options;
    options.by = "feature";
    options.each = {{"infill", "lambert:0,0,1"}};
    EXPECT_NEAR(makeObjectMaterial(options, kBase, 0, features).of(glm::vec3(2, 0, 0)).albedo.b, 1, 1e-5f);
    options.each = {{"infil", "lambert:0,0,1"}};
    EXPECT_TRUE(test::refuses<UsageError>("unknown, perimeter, infill",
                                          [&] { makeObjectMaterial(options, kBase, 0, features); }));
}

TEST(Material, PalettesTellToolsApartAndRampsGrowLighter) {
    MaterialOptions options;
    options.by = "tool";
    const auto tools = makeObjectMaterial(options, "plastic:0.1,0.1,0.1,0.2", 0, integers(0, 9));
    for (int a = 0; a < 10; ++a)
        for (int b = 0; b < a; ++b) {
            const Color d = tools.of(glm::vec3(a, 0, 0)).albedo - tools.of(glm::vec3(b, 0, 0)).albedo;
            EXPECT_GT(std::abs(d.r) + std::abs(d.g) + std::abs(d.b), 0.05f) << a << " " << b;
        }
    float last = -1.0f;
    for (int n = 0; n <= 50; ++n) {
        const float y = shade::luminance(shade::rampColor(n / 50.0));
        EXPECT_GT(y, last);
        last = y;
    }
    options.by = "layer";
    const auto layers = makeObjectMaterial(options, kBase, 0, integers(1, 200));
    EXPECT_EQ(layers.of(glm::vec3(1, 0, 0)).albedo, layers.of(glm::vec3(-5, 0, 0)).albedo);
    EXPECT_GT(shade::luminance(layers.of(glm::vec3(200, 0, 0)).albedo),
              3.0f * shade::luminance(layers.of(glm::vec3(1, 0, 0)).albedo));
}

TEST(Material, ColorsOfTheFilament) {
    AttributeSummary colors;
    colors.kind = AttributeSummary::Kind::color;
    colors.colors = {{0.0f, 0.5f, 0.25f}, {1.0f, 0.0f, 0.0f}};
    MaterialOptions options;
    options.by = "color";
    const auto material = makeObjectMaterial(options, kBase, 0, colors);
    EXPECT_NEAR(material.of(glm::vec3(0.0f, 0.5f, 0.25f)).albedo.g, shade::bodyOf(Color(0.5f)).g, 1e-5f);
    EXPECT_NEAR(material.of(glm::vec3(1.0f, 0.0f, 0.0f)).albedo.r, shade::kWhitest, 1e-5f);
    EXPECT_NEAR(material.of(glm::vec3(0.3f)).albedo.r, 0.5f, 1e-5f);  // not in the list
    options.each = {{"0", kBase}};
    EXPECT_THROW(makeObjectMaterial(options, kBase, 0, colors), UsageError);
}

// Once, a NaN became an index far behind the last material.
TEST(Material, ValuesThatAreNoNumbersAreGray) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    MaterialOptions options;
    options.by = "width";
    AttributeSummary widths;
    widths.kind = AttributeSummary::Kind::number;
    widths.least = 0.4;
    widths.most = 0.5;
    AttributeSummary colors;
    colors.kind = AttributeSummary::Kind::color;
    colors.colors = {{0.0f, 0.5f, 0.25f}};
    for (const AttributeSummary& summary : {widths, integers(0, 3), colors}) {
        const auto material = makeObjectMaterial(options, kBase, 0, summary);
        for (const float bad : {kNan, kInfinity, -kInfinity}) {
            const Color albedo = material.of(glm::vec3(bad, 0, 0)).albedo;
            EXPECT_NEAR(albedo.r, 0.18f, 1e-5f);
            EXPECT_EQ(albedo.r, albedo.b);
        }
        // So are places without a value, as in a cut that is deeper than a file's values.
        EXPECT_NEAR(material.of(std::nullopt).albedo.r, 0.18f, 1e-5f);
    }
    options.by = "tool";
    options.each = {{"1", "lambert:0,1,0"}};
    const auto material = makeObjectMaterial(options, kBase, 0, integers(0, 3));
    EXPECT_NEAR(material.of(glm::vec3(kNan, 0, 0)).albedo.r, 0.5f, 1e-5f);  // the scene's, as without a value
}

TEST(Material, PlacesWithoutAStatedColorAreOfTheScenesMaterial) {
    AttributeSummary colors;
    colors.kind = AttributeSummary::Kind::color;
    colors.colors = {{0.0f, 0.5f, 0.25f}, trace::kNoColor};
    MaterialOptions options;
    options.by = "color";
    const auto material = makeObjectMaterial(options, "lambert:0.3,0.2,0.1", 0, colors);
    EXPECT_NEAR(material.of(trace::kNoColor).albedo.r, 0.3f, 1e-5f);
    const shade::Legend legend = shade::makeLegend(options, colors, material);
    ASSERT_EQ(legend.entries.size(), 2u);
    EXPECT_EQ(legend.entries[0].name, "#00bc89");
    EXPECT_EQ(legend.entries[1].name, "not stated");
}

TEST(Material, LegendsNameWhatIsThere) {
    AttributeSummary features = integers(1, 3);
    features.labels = {"unknown", "perimeter", "infill", "skirt"};
    features.values = {1, 3};
    MaterialOptions options;
    options.by = "feature";
    const auto by_feature = makeObjectMaterial(options, kBase, 0, features);
    const shade::Legend legend = shade::makeLegend(options, features, by_feature);
    EXPECT_EQ(legend.title, "feature");
    ASSERT_EQ(legend.entries.size(), 2u);
    EXPECT_EQ(legend.entries[0].name, "perimeter");
    EXPECT_EQ(shade::hexOf(legend.entries[0].color), "#e8cf3d");
    EXPECT_EQ(legend.entries[1].name, "skirt");
    AttributeSummary speeds;
    speeds.least = 10;
    speeds.most = 60;
    options.by = "speed";
    const shade::Legend ramp = shade::makeLegend(options, speeds, makeObjectMaterial(options, kBase, 0, speeds));
    EXPECT_TRUE(ramp.entries.empty());
    EXPECT_EQ(ramp.least, 10);
    EXPECT_EQ(ramp.most, 60);
    EXPECT_GT(shade::luminance(ramp.ramp.back()), shade::luminance(ramp.ramp.front()));
    options.by = "tool";
    options.each = {{"1", "lambert:0,1,0"}};
    const shade::Legend tools =
        shade::makeLegend(options, integers(0, 1), makeObjectMaterial(options, kBase, 0, integers(0, 1)));
    ASSERT_EQ(tools.entries.size(), 1u);
    EXPECT_EQ(tools.entries[0].name, "tool 1");
    EXPECT_NEAR(tools.entries[0].color.g, 1.0f, 1e-5f);
}

TEST(Material, TablesKeepTheirColor) {
    MaterialOptions options;
    options.by = "tool";
    EXPECT_THROW(makeObjectMaterial(options, "pla-blue", 0, integers(0, 1)), UsageError);
    options.each = {{"1", "pla-blue"}};
    EXPECT_NO_THROW(makeObjectMaterial(options, kBase, 0, integers(0, 1)));
}

// A ball whose hits are of object 1, with the tool 0 below and 1 above.
class TwoTools final : public trace::Intersector {
public:
    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<Rays>(ball_); }
    std::string_view name() const override { return "two"; }
    trace::Box bounds() const override { return ball_.bounds(); }
    double voxelSize() const override { return 0.1; }
    std::size_t bytes() const override { return 0; }
    double surfaceOffset() const override { return 1e-6; }

private:
    struct Rays final : trace::Tracer {
        explicit Rays(const test::FunctionIntersector& ball) : inner(ball.makeTracer()) {}
        bool intersect(const trace::Ray& ray, trace::Hit& hit) override {
            hit.object = 1;
            return inner->intersect(ray, hit);
        }
        bool occluded(const trace::Ray& ray) override { return inner->occluded(ray); }
        glm::dvec3 shadingNormal(const trace::Hit& hit) override {
            return glm::normalize(hit.normal + glm::dvec3(0, 0, 0.2));
        }
        std::optional<glm::vec3> attribute(const trace::Hit& hit, std::size_t which) override {
            EXPECT_EQ(which, 7u);
            return glm::vec3(hit.position.z > 0 ? 1 : 0, 0, 0);
        }
        std::unique_ptr<trace::Tracer> inner;
    };
    test::FunctionIntersector ball_ = test::sphere({0, 0, 0}, 1.0);
};

TEST(Material, SurfacesTakeItByObjectAndAttribute) {
    const TwoTools print;
    shade::SceneOptions options;
    options.brdf = kBase;
    options.bed = false;
    auto scene = shade::makeScene(options, print, 8, 8);
    MaterialOptions by_tool;
    by_tool.by = "tool";
    by_tool.each = {{"0", "lambert:1,0,0"}, {"1", "lambert:0,1,0"}};
    scene.objects.emplace_back(shade::makeBrdf("lambert:0,0,1"));
    scene.objects.push_back(makeObjectMaterial(by_tool, kBase, 7, integers(0, 1)));
    const auto tracer = print.makeTracer();
    shade::SurfacePoint point;
    {
        const shade::Surfaces surfaces(scene, print);
        ASSERT_TRUE(surfaces.nearest({{5, 0, 0.5}, {-1, 0, 0}}, *tracer, point));
        EXPECT_NEAR(point.albedo.g, 1, 1e-5f);
        EXPECT_EQ(point.normal, point.geometric);
        ASSERT_TRUE(surfaces.nearest({{5, 0, -0.5}, {-1, 0, 0}}, *tracer, point));
        EXPECT_NEAR(point.albedo.r, 1, 1e-5f);
    }
    scene.smooth_normals = true;
    scene.objects.resize(1, scene.objects.front());  // object 1 has none: the scene's
    const shade::Surfaces surfaces(scene, print);
    ASSERT_TRUE(surfaces.nearest({{5, 0, 0.5}, {-1, 0, 0}}, *tracer, point));
    EXPECT_NEAR(point.albedo.b, 0.5f, 1e-5f);
    EXPECT_GT(glm::length(point.normal - point.geometric), 0.05);
    // Light leaves along the geometric one: never into the ball.
    const trace::Ray away = surfaces.leave(point, {0, 0, 1});
    EXPECT_NEAR(glm::length(away.origin), 1 + 1e-6, 1e-9);
    // At the silhouette a shading normal may look away from the viewer: then it is the geometric one.
    ASSERT_TRUE(surfaces.nearest({{5, 0, -0.995}, {-1, 0, 0}}, *tracer, point));
    EXPECT_LE(glm::dot(point.normal, glm::dvec3(-1, 0, 0)), 0);
}

TEST(Material, StreamsForgetTheObjectsOfEarlierScenes) {
    const TwoTools two;  // its hits are of object 1
    const auto ball = test::sphere({0, 0, 0}, 1.0);
    shade::SceneOptions options;
    options.bed = false;
    auto scene = shade::makeScene(options, ball, 8, 8);
    scene.objects.emplace_back(shade::makeBrdf("lambert:0,0,1"));
    scene.objects.emplace_back(shade::makeBrdf("lambert:0,1,0"));
    std::vector<trace::Ray> rays(4, {{5, 0, 0.5}, {-1, 0, 0}});
    std::vector<shade::SurfacePoint> points(rays.size());
    shade::Surfaces(scene, two).nearest(rays, *two.makeTracer(), points);
    EXPECT_NEAR(points.back().albedo.g, 1, 1e-5f);
    shade::Surfaces(scene, ball).nearest(rays, *ball.makeTracer(), points);
    for (const shade::SurfacePoint& point : points) EXPECT_NEAR(point.albedo.b, 1, 1e-5f);
}

TEST(Material, LabelsAreNumbersAndNeverMix) {
    const TwoTools print;
    shade::SceneOptions options;
    options.brdf = kBase;
    options.bed = false;
    options.camera.view = shade::View::front;
    auto scene = shade::makeScene(options, print, 33, 33);
    scene.labels[static_cast<std::size_t>(shade::Label::tool)] = 7;
    shade::RenderOptions render;
    render.width = render.height = 33;
    render.spp = 16;
    render.integrator.name = "tool";
    render.aovs = shade::parseAovs("tool,layer");
    const auto result = shade::render(print, scene, render);
    int counts[2] = {0, 0};
    for (std::size_t n = 0; n < result.film.pixels().size(); ++n) {
        const float tool = result.film.layers()[0].values[n];
        ASSERT_TRUE(tool == -1.0f || tool == 0.0f || tool == 1.0f) << tool;
        ASSERT_EQ(result.film.layers()[1].values[n], -1.0f);  // nobody knows the layer
        ASSERT_EQ(tool < 0.0f, result.film.pixels()[n].alpha == 0.0f);
        if (tool >= 0.0f) ++counts[static_cast<std::size_t>(tool)];
    }
    EXPECT_GT(counts[0], 100);
    EXPECT_GT(counts[1], 100);
    const auto colorAt = [&](int x, int y) { return result.film.pixels()[result.film.index(x, y)].rgb; };
    EXPECT_NEAR(colorAt(16, 8).g, shade::categoryColor(1).g, 1e-4f);
    EXPECT_NEAR(colorAt(16, 24).r, shade::categoryColor(0).r, 1e-4f);
    EXPECT_EQ(shade::labelsOf(render.aovs), (std::vector<shade::Label>{shade::Label::tool, shade::Label::layer}));
}

TEST(ObjectMaterial, AColorMayHaveAMaterialOfItsOwn) {
    trace::AttributeSummary summary;
    summary.kind = trace::AttributeSummary::Kind::color;
    const glm::vec3 orange = shade::fromSrgb(0xff8000);
    const glm::vec3 blue = shade::fromSrgb(0x0000ff);
    summary.colors = {blue, orange};
    shade::MaterialOptions options;
    options.by = "color";
    options.each = {{"#ff8000", "matte:0.9,0.3,0.02"}};
    const auto material = shade::makeObjectMaterial(options, "", 0, summary);
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    EXPECT_EQ(material.of(orange).brdf->eval(up, up), shade::makeBrdf("matte:0.9,0.3,0.02")->eval(up, up));
    EXPECT_NE(material.of(blue).brdf->eval(up, up), material.of(orange).brdf->eval(up, up));
    EXPECT_EQ(shade::makeLegend(options, summary, material).entries.size(), 2u);
    options.each = {{"orangish", "matte:0.9,0.3,0.02"}};
    EXPECT_THROW((void)shade::makeObjectMaterial(options, "", 0, summary), UsageError);
}

}  // namespace
}  // namespace stratum
