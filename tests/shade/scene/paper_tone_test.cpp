#include "shade/scene/paper_tone.h"
#include "shade/finish/named_brdf.h"

#include "shade/analytic_prints.h"
#include "shade/integrator/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace stratum {
namespace {

using shade::Color;

constexpr Color kWhite(0.86f), kSilver(0.45f), kGray(0.2f), kBlack(0.012f), kOrange(0.82f, 0.21f, 0.03f),
    kYellow(0.86f, 0.7f, 0.05f);

TEST(PaperTone, DifferencesAreThoseOfCie1976) {
    EXPECT_NEAR(shade::colorDifference(Color(1.0f), Color(0.0f)), 100.0, 1e-3);
    EXPECT_NEAR(shade::colorDifference(Color(1.0f, 0.0f, 0.0f), Color(0.0f)), 117.34, 0.1);  // L 53.24 a 80.09 b 67.20
    EXPECT_EQ(shade::colorDifference(kOrange, kOrange), 0.0);
}

TEST(PaperTone, FollowsThePart) {
    const Color light = shade::BedTexture(shade::BedSurface::paper).mean();
    const auto paperOf = [](const Color& part) { return shade::paperFor(std::array{part}); };
    for (const Color& part : {kBlack, kGray, kOrange, kYellow}) EXPECT_EQ(paperOf(part), light) << part.r;
    for (const Color& part : {kWhite, kSilver, light}) {
        EXPECT_LT(paperOf(part).g, 0.3f * part.g);
        EXPECT_EQ(paperOf(part).r, paperOf(part).b);
    }
    for (float gray = 0.012f; gray < 0.87f; gray += 0.002f)
        EXPECT_GE(shade::colorDifference(Color(gray), paperOf(Color(gray))), shade::kLeastDifference) << gray;
    // Of several parts the one that is hardest to see decides, unless the other paper is worse.
    EXPECT_LT(shade::paperFor(std::array{kWhite, kOrange}).g, light.g);
    EXPECT_EQ(shade::paperFor(std::array{Color(0.5f), Color(0.12f)}), light);
}

TEST(PaperTone, FollowsEachFilamentOfAPrint) {
    const auto ball = test::sphere({0, 0, 10}, 10.0);
    const auto paperOf = [&ball](const std::vector<glm::vec3>& colors, trace::AttributeSummary::Kind kind) {
        trace::AttributeSummary summary;
        summary.kind = kind;
        summary.colors = colors;
        summary.most = 1;
        shade::MaterialOptions options;
        options.by = "color";
        auto scene = shade::makeScene({}, ball, 64, 48);
        scene.objects.push_back(shade::makeObjectMaterial(options, "plastic:0.8,0.2,0.1,0.2", 0, summary));
        shade::matchPaper(scene, shade::BedSurface::paper);
        return scene.bed->texture.mean();
    };
    using Kind = trace::AttributeSummary::Kind;
    const Color light = shade::BedTexture(shade::BedSurface::paper).mean();
    const glm::vec3 teal(0.0f, 0.6f, 0.5f), blue(0.02f, 0.1f, 0.3f);
    EXPECT_EQ(paperOf({blue, teal}, Kind::color), light);
    EXPECT_LT(paperOf({teal, glm::vec3(1.0f)}, Kind::color).g, 0.3f);
    // The colors of a ramp say nothing about the plastic.
    EXPECT_EQ(paperOf({teal, glm::vec3(1.0f)}, Kind::number), light);
}

/// Of neighbours on both sides of the silhouette: the share whose luminances differ by a fifth of the larger one.
double distinct(const Color& body, bool match) {
    const auto ball = test::sphere({0, 0, 10}, 10.0);
    shade::RenderOptions options;
    options.width = 128;
    options.height = 96;
    options.spp = 32;
    options.aovs = {shade::Aov::mask};
    auto scene = shade::makeScene({}, ball, options.width, options.height);
    scene.material = shade::makeBrdf("plastic:" + std::to_string(body.r) + "," + std::to_string(body.g) + "," +
                                     std::to_string(body.b) + ",0.22");
    if (match) shade::matchPaper(scene, shade::BedSurface::paper);
    const auto film = shade::render(ball, scene, options).film;
    const auto mask = [&](int x, int y) { return film.layers()[0].values[film.index(x, y)]; };
    int count = 0;
    int seen = 0;
    // Two pixels apart, because those on the silhouette are mixed.
    for (int y = 0; y < options.height; ++y)
        for (int x = 0; x + 3 < options.width; ++x) {
            const float a = mask(x, y);
            const float b = mask(x + 3, y);
            if (std::abs(a - b) < 1.0f || mask(x + 1, y) == mask(x + 2, y)) continue;
            const float p = shade::luminance(film.at(x, y).rgb);
            const float q = shade::luminance(film.at(x + 3, y).rgb);
            ++count;
            if (std::abs(p - q) > 0.2f * std::max(p, q)) ++seen;
        }
    EXPECT_GT(count, 50);
    return seen / double(count);
}

TEST(PaperTone, SilhouettesOfGrayPartsStandOut) {
    for (const Color& part : {kWhite, kSilver, kGray, kBlack}) {
        const double before = distinct(part, false);
        const double after = distinct(part, true);
        std::printf("reflectance %.3f: %.0f %% of the silhouette, %.0f %% on paper of its own\n", double(part.g),
                    100 * before, 100 * after);
        EXPECT_GE(after, 0.9) << part.g;
    }
}

}  // namespace
}  // namespace stratum
