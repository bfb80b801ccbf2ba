#include "shade/brdf/lobe_fit.h"

#include "base/parallel_for.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr double kEta = 1.5;
constexpr double kF0 = 0.04;
constexpr double kLeastAlpha = 0.005;

struct Readings {
    std::vector<GlossyPair> pairs;
    std::array<std::vector<double>, 3> values;  // by channel, as many as pairs
};

std::vector<double> glossOf(const std::vector<GlossyPair>& pairs, double alpha) {
    std::vector<double> gloss;
    gloss.reserve(pairs.size());
    for (const GlossyPair& pair : pairs) gloss.push_back(pair.gloss(alpha));
    return gloss;
}

struct Fit {
    double kd = 0.0, ks = 0.0;
    double error = std::numeric_limits<double>::infinity();
};

/// kd and ks for one alpha by Gauss-Newton steps on the squared log error, both kept positive.
/// @param gloss  glossOf() of that alpha
Fit fitAt(const std::vector<double>& values, const std::vector<double>& gloss) {
    double diffuse = std::numeric_limits<double>::infinity();
    for (const double value : values) diffuse = std::min(diffuse, value);
    Fit fit;
    fit.kd = std::max(diffuse * std::numbers::pi, 1e-6);
    fit.ks = 0.04;
    for (int step = 0; step < 16; ++step) {
        double aa = 0.0, ab = 0.0, bb = 0.0, ar = 0.0, br = 0.0, error = 0.0;
        for (std::size_t n = 0; n < values.size(); ++n) {
            const double f = fit.kd / std::numbers::pi + fit.ks * gloss[n];
            const double r = std::log(values[n] / f);
            // In log kd and log ks, so that neither can change its sign.
            const double a = fit.kd / std::numbers::pi / f;
            const double b = fit.ks * gloss[n] / f;
            aa += a * a;
            ab += a * b;
            bb += b * b;
            ar += a * r;
            br += b * r;
            error += r * r;
        }
        fit.error = error / static_cast<double>(values.size());
        const double ridge = 1e-9 * (aa + bb) + 1e-12;
        aa += ridge;
        bb += ridge;
        const double determinant = aa * bb - ab * ab;
        const double da = std::clamp((ar * bb - br * ab) / determinant, -2.0, 2.0);
        const double db = std::clamp((br * aa - ar * ab) / determinant, -2.0, 2.0);
        fit.kd = std::max(fit.kd * std::exp(da), 1e-9);
        fit.ks = std::max(fit.ks * std::exp(db), 1e-9);
        if (std::abs(da) + std::abs(db) < 1e-6) break;
    }
    return fit;
}

constexpr int kCoarse = 40;  // alphas that are tried first, evenly by their logarithms
const double kLowest = std::log(kLeastAlpha);
const double kStep = -kLowest / (kCoarse - 1);

/// The best lobes of a channel.
/// @param coarse  its fits for the coarse alphas
Lobes refined(const Readings& readings, std::size_t channel, const std::array<std::array<Fit, 3>, kCoarse>& coarse) {
    double best_log = 0.0;
    Fit best;
    for (int i = 0; i < kCoarse; ++i) {
        const Fit& fit = coarse[static_cast<std::size_t>(i)][channel];
        if (fit.error < best.error) {
            best = fit;
            best_log = kLowest + i * kStep;
        }
    }
    // Halving steps around the best.
    double s = kStep;
    for (int halving = 0; halving < 7; ++halving) {
        s *= 0.5;
        for (const double candidate : {best_log - s, best_log + s}) {
            if (candidate < kLowest || candidate > 0.0) continue;
            const Fit fit = fitAt(readings.values[channel], glossOf(readings.pairs, std::exp(candidate)));
            if (fit.error < best.error) {
                best = fit;
                best_log = candidate;
                break;
            }
        }
    }
    return {best.kd, best.ks, std::exp(best_log)};
}

}  // namespace

GlossyPair::GlossyPair(const glm::dvec3& light, const glm::dvec3& detector, const glm::dvec3& half)
    : light_(light), detector_(detector), half_(half) {
    const double c = std::clamp(0.5 * (glm::dot(half, light) + glm::dot(half, detector)), 0.0, 1.0);
    const double t = std::sqrt(1.0 - (1.0 - c * c) / (kEta * kEta));
    const double parallel = (kEta * c - t) / (kEta * c + t);
    const double perpendicular = (c - kEta * t) / (c + kEta * t);
    fresnel_ = 0.5 * (parallel * parallel + perpendicular * perpendicular) / kF0;
}

double GlossyPair::gloss(double alpha) const {
    const double a2 = alpha * alpha;
    const double k = a2 * half_.cosine * half_.cosine + half_.sine2;
    const auto stretch = [a2](const Slope& w) { return std::sqrt(w.cosine * w.cosine + a2 * w.sine2); };
    const double visibility =
        0.5 / std::max(stretch(detector_) * light_.cosine + stretch(light_) * detector_.cosine, 1e-12);
    return fresnel_ * a2 / (std::numbers::pi * k * k) * visibility;
}

double Lobes::eval(const GlossyPair& pair) const { return kd / std::numbers::pi + ks * pair.gloss(alpha); }

std::array<Lobes, 3> fitLobes(const BrdfScan& scan) {
    // A subset of the readings of a fine scan is sufficient.
    const std::size_t step_a = std::max<std::size_t>(1, scan.azimuths.size() / 18);
    const std::size_t step_p = std::max<std::size_t>(1, scan.polars.size() / 45);
    constexpr double kGrazing = 85.0 * std::numbers::pi / 180.0;  // beyond, measurements are unreliable
    std::array<float, 3> peaks{};
    for (const Color& v : scan.values)
        for (int c = 0; c < 3; ++c)
            peaks[static_cast<std::size_t>(c)] = std::max(peaks[static_cast<std::size_t>(c)], v[c]);
    Readings readings;
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const double ti = scan.incidences[i];
        for (std::size_t a = 0; a < scan.azimuths.size(); a += step_a) {
            for (std::size_t p = 0; p < scan.polars.size(); p += step_p) {
                const double tp = scan.polars[p];
                if (tp > kGrazing) continue;
                const double phi = scan.azimuths[a];
                readings.pairs.emplace_back(
                    glm::dvec3(std::sin(ti), 0.0, std::cos(ti)),
                    glm::dvec3(std::sin(tp) * std::cos(phi), std::sin(tp) * std::sin(phi), std::cos(tp)));
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto v = static_cast<double>(scan.values[scan.index(i, a, p)][static_cast<int>(c)]);
                    readings.values[c].push_back(std::max({v, 1e-5 * static_cast<double>(peaks[c]), 1e-7}));
                }
            }
        }
    }
    std::array<std::array<Fit, 3>, kCoarse> coarse;
    parallelFor(kCoarse, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) {
            const auto gloss = glossOf(readings.pairs, std::exp(kLowest + static_cast<double>(n) * kStep));
            for (std::size_t c = 0; c < 3; ++c) coarse[n][c] = fitAt(readings.values[c], gloss);
        }
    });
    std::array<Lobes, 3> lobes;
    parallelFor(3, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c) lobes[c] = refined(readings, c, coarse);
    });
    return lobes;
}

}  // namespace stratum::shade
