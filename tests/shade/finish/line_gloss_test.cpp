#include "shade/finish/line_gloss.h"

#include "base/error.h"
#include "shade/analytic_prints.h"
#include "shade/brdf_checks.h"
#include "shade/finish/named_brdf.h"
#include "shade/frame.h"
#include "shade/scene/scene.h"
#include "shade/scene/surface.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>

namespace stratum {
namespace {

using shade::Color;
using shade::Ggx;
using shade::Plastic;

constexpr double kCosines[] = {0.02, 0.1, 0.3, 0.6, 0.9, 1.0};
constexpr double kAzimuths[] = {0.0, 0.7, 0.5 * std::numbers::pi, 2.5};

TEST(LineGloss, FacetsCoverThePlaneOnce) {
    // The projected area of all facets is that of the surface: integral of D cos = 1.
    for (const Ggx& ggx : {Ggx(0.3f), Ggx(0.15f, 0.4f), Ggx(0.5f, 1.0f)})
        EXPECT_NEAR(test::overHemisphere([&](const glm::vec3& h) { return double(ggx.d(h) * h.z); }, 2000, 720), 1.0,
                    2e-3);
}

TEST(LineGloss, EqualAlphasAreTheIsotropicDistribution) {
    // D, and the length of stretched directions, by the isotropic formulas.
    const float alpha = 0.22f;
    const Ggx ggx(alpha);
    for (const double c : kCosines)
        for (const double azimuth : kAzimuths) {
            const glm::vec3 w = test::direction(c, azimuth);
            const float sine2 = w.x * w.x + w.y * w.y;
            const float k = alpha * alpha * w.z * w.z + w.x * w.x + w.y * w.y;
            EXPECT_EQ(ggx.d(w), alpha * alpha / (shade::kPi * k * k));
            EXPECT_EQ(ggx.stretch(w), std::sqrt(w.z * w.z + alpha * alpha * sine2));
        }
}

TEST(LineGloss, IsReciprocal) {
    for (const float ratio : {1.5f, 2.5f, 8.0f})
        EXPECT_LT(test::asymmetry(shade::plasticOfLines(Color(0.8f, 0.4f, 0.1f), 0.25f, ratio)), 1e-6) << ratio;
}

TEST(LineGloss, WhiteBodyLosesAndGainsNothing) {
    for (const float ratio : {2.5f, 6.0f}) {
        const Plastic brdf = shade::plasticOfLines(Color(1.0f), 0.3f, ratio);
        for (const double c : kCosines)
            for (const double azimuth : kAzimuths)
                EXPECT_NEAR(test::albedo(brdf, test::direction(c, azimuth), 800, 800), 1.0, 2.5e-3)
                    << "ratio " << ratio << " cosine " << c << " azimuth " << azimuth;
    }
}

TEST(LineGloss, SamplesAgreeWithQuadratureAndDensity) {
    const Plastic brdf = shade::plasticOfLines(Color(0.5f), 0.3f, 3.0f);
    for (const double c : {0.1, 0.4, 0.95})
        for (const double azimuth : kAzimuths) {
            const glm::vec3 wo = test::direction(c, azimuth);
            EXPECT_NEAR(test::sampledAlbedo(brdf, wo), test::albedo(brdf, wo, 800, 800), 4e-3) << c << " " << azimuth;
            EXPECT_LT(test::chiSquaredZ(brdf, wo, 400000, 3), 4.0) << c << " " << azimuth;
        }
}

TEST(LineGloss, TheHighlightIsLongAcrossTheLine) {
    // From above: at 30 degrees, a light across the line is still in the highlight, one along it is not.
    const Plastic brdf = shade::plasticOfLines(Color(0.0f), 0.2f, 4.0f);
    const glm::vec3 above(0, 0, 1);
    const float along = brdf.eval(above, test::direction(std::cos(0.5), 0.0)).r;
    const float across = brdf.eval(above, test::direction(std::cos(0.5), 0.5 * std::numbers::pi)).r;
    EXPECT_GT(across, 5 * along);
    // Without a direction it is the plastic of the mean alpha.
    ASSERT_NE(brdf.undirected(), nullptr);
    const Plastic mean(Color(0.0f), 0.2f);
    EXPECT_NEAR(brdf.undirected()->eval(above, above).r, mean.eval(above, above).r, 1e-4f);
    EXPECT_EQ(mean.undirected(), nullptr);
    EXPECT_EQ(brdf.undirected()->undirected(), nullptr);
}

TEST(LineGloss, RecoloredInBothForms) {
    const Plastic black = shade::plasticOfLines(Color(0.0f), 0.2f);
    const auto red = black.recolored(Color(0.7f, 0.1f, 0.1f));
    EXPECT_NEAR(shade::reflectanceFactor(*red).r, shade::reflectanceFactor(*red->undirected()).r, 0.05f);
    EXPECT_GT(shade::reflectanceFactor(*red->undirected()).r, 3 * shade::reflectanceFactor(*red->undirected()).g);
}

TEST(LineGloss, IsReadFromText) {
    EXPECT_NE(shade::makeBrdf("fdm:0.5,0.2,0.1,0.22")->undirected(), nullptr);
    EXPECT_NE(shade::makeBrdf("fdm:0.5,0.2,0.1,0.22,4")->undirected(), nullptr);
    EXPECT_EQ(shade::makeBrdf("fdm:0.5,0.2,0.1,0.22,1")->undirected(), nullptr);
    for (const char* bad : {"fdm", "fdm:0.5", "fdm:2,0,0,0.2", "fdm:0,0,0,0", "fdm:0,0,0,1.5", "fdm:0,0,0,0.2,0.5",
                            "fdm:0,0,0,0.2,21", "fdm:0,0,0,0.2,nan", "fdm:0,0,0,0.2,2,3"})
        EXPECT_THROW((void)shade::makeBrdf(bad), UsageError) << bad;
    EXPECT_TRUE(shade::hasGlossOfLines(shade::withGlossOfLines("")));
    EXPECT_TRUE(shade::hasGlossOfLines(shade::withGlossOfLines("#ff6600")));
    EXPECT_EQ(shade::withGlossOfLines("pla-blue"), "pla-blue");
    EXPECT_EQ(shade::withGlossOfLines("lambert:1,1,1"), "lambert:1,1,1");
    (void)shade::makeBrdf(shade::withGlossOfLines(""));
    (void)shade::makeBrdf(shade::withGlossOfLines("teal"));
}

TEST(LineGloss, FramesLieAlongTheGrain) {
    const glm::vec3 normal = test::direction(0.6, 1.0);
    for (const glm::vec3& grain : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0.5f, 0.5f, 0.7f)}) {
        const shade::Frame frame(normal, grain);
        EXPECT_NEAR(glm::dot(frame.y, grain), 0, 1e-6f);
        EXPECT_GT(glm::dot(frame.x, grain), 0);
        EXPECT_NEAR(glm::length(frame.x), 1, 1e-6f);
        EXPECT_NEAR(glm::length(glm::cross(frame.x, frame.y) - frame.z), 0, 1e-6f);
    }
    // What has no part in the plane leaves the basis as it is.
    for (const glm::vec3& grain : {normal, -normal, glm::vec3(0.0f)})
        EXPECT_EQ(shade::Frame(normal, grain).x, shade::Frame(normal).x);
}

// A ball whose beads run along x in its upper half and are not known in the lower one.
class LinedBall final : public trace::Intersector {
public:
    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<Rays>(ball_, asked_); }
    std::string_view name() const override { return "lined"; }
    trace::Box bounds() const override { return ball_.bounds(); }
    double voxelSize() const override { return 0.1; }
    std::size_t bytes() const override { return 0; }
    double surfaceOffset() const override { return 1e-6; }
    int asked() const { return asked_; }

private:
    struct Rays final : trace::Tracer {
        Rays(const test::FunctionIntersector& ball, int& count) : inner(ball.makeTracer()), asked(count) {}
        bool intersect(const trace::Ray& ray, trace::Hit& hit) override { return inner->intersect(ray, hit); }
        bool occluded(const trace::Ray& ray) override { return inner->occluded(ray); }
        glm::dvec3 grain(const trace::Hit& hit) override {
            ++asked;
            return hit.position.z > 0 ? glm::dvec3(1, 0, 0) : glm::dvec3(0);
        }
        std::unique_ptr<trace::Tracer> inner;
        int& asked;
    };
    test::FunctionIntersector ball_ = test::sphere({0, 0, 0}, 1.0);
    mutable int asked_ = 0;
};

TEST(LineGloss, SurfacesAskForTheGrainWhereTheCameraLooks) {
    const LinedBall ball;
    shade::SceneOptions options;
    options.bed = false;
    options.brdf = "plastic:0.5,0.5,0.5,0.2";
    std::vector<trace::Ray> rays(2, {{5, 0, 0.5}, {-1, 0, 0}});
    rays[1].origin.z = -0.5;
    std::vector<shade::SurfacePoint> points(rays.size());
    const auto tracer = ball.makeTracer();
    const auto plain = shade::makeScene(options, ball, 8, 8);
    shade::Surfaces(plain, ball).nearest(rays, *tracer, points);
    EXPECT_EQ(ball.asked(), 0);
    EXPECT_EQ(points[0].grain, glm::vec3(0.0f));

    options.brdf = "fdm:0.5,0.5,0.5,0.2";
    const auto lined = shade::makeScene(options, ball, 8, 8);
    const shade::Surfaces surfaces(lined, ball);
    surfaces.nearest(rays, *tracer, points);
    EXPECT_EQ(ball.asked(), 2);
    EXPECT_EQ(points[0].grain, glm::vec3(1, 0, 0));
    EXPECT_NE(points[0].brdf->undirected(), nullptr);
    EXPECT_EQ(points[1].brdf->undirected(), nullptr) << "no direction, no gloss of lines";
    surfaces.nearestBounced(rays, *tracer, points);
    EXPECT_EQ(ball.asked(), 2);
    EXPECT_EQ(points[0].brdf->undirected(), nullptr);
}

}  // namespace
}  // namespace stratum
