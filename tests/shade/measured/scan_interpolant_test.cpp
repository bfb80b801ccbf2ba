#include "shade/measured/scan_interpolant.h"

#include "corpus.h"
#include "shade/measured/text_readers.h"
#include "shade/scan_checks.h"

#include <zlib.h>

#include <random>

namespace stratum {
namespace {

using shade::BrdfScan;
using shade::ScanInterpolant;

glm::dvec3 directionOf(double polar, double azimuth) {
    return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

std::string gunzipped(const std::filesystem::path& path) {
    std::string text;
    gzFile file = gzopen(path.c_str(), "rb");
    char chunk[65536];
    for (int n = 0; (n = gzread(file, chunk, sizeof(chunk))) > 0;) text.append(chunk, static_cast<std::size_t>(n));
    gzclose(file);
    return text;
}

/// The scan without one of its incidences.
BrdfScan without(const BrdfScan& scan, std::size_t left_out) {
    BrdfScan rest{{}, scan.azimuths, scan.polars, {}, {}};
    const std::size_t block = scan.azimuths.size() * scan.polars.size();
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        if (i == left_out) continue;
        rest.incidences.push_back(scan.incidences[i]);
        rest.values.insert(rest.values.end(), scan.values.begin() + std::ptrdiff_t(i * block),
                           scan.values.begin() + std::ptrdiff_t((i + 1) * block));
    }
    return rest;
}

/// RMS difference of logarithms over all channels and angles of detection below 90 degrees.
template <typename F>
double logError(const BrdfScan& scan, std::size_t incidence, const F& f) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t a = 0; a < scan.azimuths.size(); ++a) {
        for (std::size_t p = 0; p + 1 < scan.polars.size(); ++p) {
            const glm::dvec3 got = f(a, p);
            for (int c = 0; c < 3; ++c) {
                const double truth = double(scan.values[scan.index(incidence, a, p)][c]);
                const double e = std::log(std::max(got[c], 1e-6) / std::max(truth, 1e-6));
                sum += e * e;
                ++count;
            }
        }
    }
    return std::sqrt(sum / double(count));
}

TEST(ScanInterpolant, IsExactAtMeasuredAngles) {
    const BrdfScan scan = test::knownScan({0, 20, 40, 60});
    const ScanInterpolant whole(scan);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(logError(scan, i,
                           [&](std::size_t a, std::size_t p) {
                               return whole.eval(directionOf(scan.incidences[i], 0.0),
                                                 directionOf(scan.polars[p], scan.azimuths[a]));
                           }),
                  1e-6);
}

TEST(ScanInterpolant, IsReciprocalAndFinite) {
    const ScanInterpolant whole(test::knownScan({0, 20, 40, 60}));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int n = 0; n < 50000; ++n) {
        const glm::dvec3 a = directionOf(std::acos(uniform(random)), 6.28 * uniform(random));
        const glm::dvec3 b = directionOf(std::acos(uniform(random)), 6.28 * uniform(random));
        const glm::dvec3 ab = whole.eval(a, b);
        const glm::dvec3 ba = whole.eval(b, a);
        for (int c = 0; c < 3; ++c) {
            ASSERT_TRUE(std::isfinite(ab[c]) && ab[c] > 0.0);
            ASSERT_NEAR(ab[c], ba[c], 1e-9 * ab[c]);
        }
    }
    for (const double polar : {0.0, 1e-9, 0.5 * std::numbers::pi, 1.6})
        for (const double other : {0.0, 1.0471975512, 0.5 * std::numbers::pi})
            for (const double azimuth : {0.0, 1.0, std::numbers::pi}) {
                const glm::dvec3 f = whole.eval(directionOf(polar, 0.0), directionOf(other, azimuth));
                EXPECT_TRUE(std::isfinite(f.x) && f.x > 0.0) << polar << " " << other;
            }
}

TEST(ScanInterpolant, BeatsLinearLookUpOnWhatItHasNotSeen) {
    // The known surface at incidences between and beyond the four.
    const BrdfScan four = test::knownScan({0, 20, 40, 60});
    const ScanInterpolant whole(four);
    for (const double degrees : {10.0, 30.0, 50.0, 70.0}) {
        const BrdfScan truth = test::knownScan({degrees});
        const double ours = logError(truth, 0, [&](std::size_t a, std::size_t p) {
            return whole.eval(directionOf(truth.incidences[0], 0.0), directionOf(truth.polars[p], truth.azimuths[a]));
        });
        const auto place = shade::placeAmong(four.incidences, truth.incidences[0]);
        const double linear = logError(truth, 0, [&](std::size_t a, std::size_t p) {
            return (1.0 - place.weight) * glm::dvec3(four.values[four.index(place.low, a, p)]) +
                   place.weight * glm::dvec3(four.values[four.index(place.low + 1, a, p)]);
        });
        std::printf("known surface at %.0f degrees: rms log error %.4f, linear look-up %.4f\n", degrees, ours, linear);
        EXPECT_LT(3.0 * ours, linear) << degrees;
    }
}

TEST(ScanInterpolant, LeaveOneAngleOut) {
    double ours = 0.0;
    double linear = 0.0;
    double ours_beyond = 0.0;
    double linear_beyond = 0.0;
    for (const char* name :
         {"merl_black-soft-plastic", "merl_red-plastic", "merl_white-acrylic", "rgl_vch_ultra_pink_rgb"}) {
        STRATUM_NEEDS_CORPUS(file, std::string("brdf/") + name + ".bsdf.gz");
        const BrdfScan scan = shade::foldScan(shade::readMiniDiff(gunzipped(file), name));
        ASSERT_EQ(scan.incidences.size(), 4u);
        for (const std::size_t out : {1u, 2u, 3u}) {
            const BrdfScan rest = without(scan, out);
            const ScanInterpolant whole(rest);
            const double e = logError(scan, out, [&](std::size_t a, std::size_t p) {
                return whole.eval(directionOf(scan.incidences[out], 0.0),
                                  directionOf(scan.polars[p], scan.azimuths[a]));
            });
            const auto place = shade::placeAmong(rest.incidences, scan.incidences[out]);
            const double l = logError(scan, out, [&](std::size_t a, std::size_t p) {
                return (1.0 - place.weight) * glm::dvec3(rest.values[rest.index(place.low, a, p)]) +
                       place.weight * glm::dvec3(rest.values[rest.index(place.low + 1, a, p)]);
            });
            std::printf("%s without %2.0f degrees: rms log error %.4f, linear look-up %.4f\n", name,
                        scan.incidences[out] / test::kRadians, e, l);
            (out == 3u ? ours_beyond : ours) += e * e;
            (out == 3u ? linear_beyond : linear) += l * l;
        }
    }
    std::printf("all, between angles: %.4f, linear %.4f; beyond the last: %.4f, linear %.4f\n", std::sqrt(ours / 8),
                std::sqrt(linear / 8), std::sqrt(ours_beyond / 4), std::sqrt(linear_beyond / 4));
    EXPECT_LT(3.0 * std::sqrt(ours), std::sqrt(linear));
    EXPECT_LT(std::sqrt(ours_beyond), std::sqrt(linear_beyond));
}

}  // namespace
}  // namespace stratum
