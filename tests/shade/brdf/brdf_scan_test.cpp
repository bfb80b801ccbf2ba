#include "shade/brdf/brdf_scan.h"

#include "base/error.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

#include <limits>

namespace stratum {
namespace {

using shade::BrdfScan;
using shade::Color;

BrdfScan flat(std::vector<double> azimuths, float value = 0.2f) {
    BrdfScan scan{{0.0}, std::move(azimuths), shade::evenAngles(0.0, 0.5 * std::numbers::pi, 91), {}, {}};
    scan.values.assign(scan.azimuths.size() * scan.polars.size(), Color(value));
    return scan;
}

TEST(BrdfScan, PlacesAmongNodes) {
    const std::vector<double> nodes = {1.0, 2.0, 4.0};
    EXPECT_EQ(shade::placeAmong(nodes, 0.0).weight, 0.0);
    EXPECT_EQ(shade::placeAmong(nodes, 3.0).low, 1u);
    EXPECT_EQ(shade::placeAmong(nodes, 3.0).weight, 0.5);
    EXPECT_EQ(shade::placeAmong(nodes, 9.0).low, 1u);
    EXPECT_EQ(shade::placeAmong(nodes, 9.0).weight, 1.0);
    EXPECT_EQ(shade::placeAmong({5.0}, 9.0).low, 0u);
}

TEST(BrdfScan, AlbedoOfAFlatScanIsPiTimesItsValue) {
    EXPECT_NEAR(double(shade::scanAlbedo(flat(shade::evenAngles(0.0, std::numbers::pi, 19)), 0).r),
                0.2 * std::numbers::pi, 2e-4);
    EXPECT_NEAR(double(shade::scanAlbedo(flat(shade::evenAngles(0.0, 2.0 * std::numbers::pi, 37)), 0).r),
                0.2 * std::numbers::pi, 2e-4);
}

TEST(BrdfScan, FoldAveragesBothSides) {
    BrdfScan scan = flat(test::radians({0, 90, 180, 270}));
    for (std::size_t p = 0; p < scan.polars.size(); ++p) {
        scan.values[scan.index(0, 1, p)] = Color(0.1f);
        scan.values[scan.index(0, 3, p)] = Color(-0.5f);
    }
    const BrdfScan folded = shade::foldScan(scan);
    ASSERT_EQ(folded.azimuths.size(), 3u);
    EXPECT_EQ(folded.values[folded.index(0, 0, 5)], Color(0.2f));
    EXPECT_EQ(folded.values[folded.index(0, 1, 5)], Color(0.0f));  // -0.2, a reading below the instrument's zero
    EXPECT_FALSE(folded.notes.empty());
}

TEST(BrdfScan, FindsAndTurnsTheMirrorSide) {
    const BrdfScan known = test::knownScan({0, 30, 60});
    for (const double origin : {0.0, 90.0, 180.0, 270.0}) {
        const auto turned = shade::makeScan(
            [&](const glm::dvec3& light, const glm::dvec3& d) {
                const double c = std::cos(origin * test::kRadians);
                const double s = std::sin(origin * test::kRadians);
                return test::knownBrdf(light, {c * d.x + s * d.y, c * d.y - s * d.x, d.z});
            },
            known.incidences, shade::evenAngles(0.0, 2.0 * std::numbers::pi, 73), known.polars);
        const double mirror = shade::findMirrorAzimuth(turned);
        EXPECT_NEAR(std::cos(mirror - (origin + 180.0) * test::kRadians), 1.0, 1e-9) << origin;
        EXPECT_LT(test::worst(shade::foldScan(shade::turnScan(turned, mirror))), 1e-4) << origin;
    }
}

TEST(BrdfScan, RefusesWhatIsNoScan) {
    const auto refused = [](BrdfScan scan) { EXPECT_THROW(scan.check("t"), InputError); };
    const BrdfScan good = flat(test::radians({0, 90, 180}));
    EXPECT_NO_THROW(good.check("t"));
    BrdfScan bad = good;
    bad.values[7].g = std::numeric_limits<float>::quiet_NaN();
    refused(bad);
    bad = good;
    bad.incidences = {1.6};
    refused(bad);
    bad = good;
    bad.azimuths = {0.0, 2.0, 1.0};
    refused(bad);
    bad = good;
    bad.polars.back() = 2.0;
    refused(bad);
    refused(flat(test::radians({0, 90, 180}), 0.0f));
    bad = good;
    bad.incidences.clear();
    refused(bad);
}

}  // namespace
}  // namespace stratum
