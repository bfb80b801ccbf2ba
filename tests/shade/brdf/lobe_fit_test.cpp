#include "shade/brdf/lobe_fit.h"

#include "shade/scan_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::Lobes;

TEST(LobeFit, FindsWhatIsThere) {
    const Lobes truth[3] = {{0.6, 0.05, 0.1}, {0.05, 0.04, 0.35}, {0.3, 0.01, 0.02}};
    const auto scan = shade::makeScan(
        [&](const glm::dvec3& l, glm::dvec3 d) {
            d.z = std::max(d.z, 1e-4);
            const shade::GlossyPair pair(l, d);
            return shade::Color(truth[0].eval(pair), truth[1].eval(pair), truth[2].eval(pair));
        },
        test::radians({0, 20, 40, 60}), shade::evenAngles(0.0, std::numbers::pi, 37),
        shade::evenAngles(0.0, 0.5 * std::numbers::pi, 91));
    const auto found = shade::fitLobes(scan);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(found[c].kd, truth[c].kd, 0.01 * truth[c].kd) << c;
        EXPECT_NEAR(found[c].ks, truth[c].ks, 0.03 * truth[c].ks) << c;
        EXPECT_NEAR(found[c].alpha, truth[c].alpha, 0.02 * truth[c].alpha) << c;
    }
}

TEST(LobeFit, StaysFiniteOnWhatHasNoLobes) {
    for (const float value : {1e-6f, 0.3f}) {
        auto scan = test::knownScan({0, 60});
        for (auto& v : scan.values) v = shade::Color(value, 0.0f, value);
        scan.values[17] = shade::Color(1.0f);
        for (const Lobes& l : shade::fitLobes(scan)) {
            EXPECT_TRUE(std::isfinite(l.kd) && std::isfinite(l.ks) && std::isfinite(l.alpha));
            EXPECT_GE(l.kd, 0.0);
            EXPECT_GE(l.ks, 0.0);
        }
    }
}

}  // namespace
}  // namespace stratum
