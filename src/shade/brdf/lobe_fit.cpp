#include "shade/brdf/lobe_fit.h"

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

struct Reading {
    glm::dvec3 light, detector;
    double value;
};

struct Fit {
    double kd = 0.0, ks = 0.0;
    double error = std::numeric_limits<double>::infinity();
};

/// kd and ks for one alpha by Gauss-Newton steps on the squared log error, both kept positive.
Fit fitAt(const std::vector<Reading>& readings, double alpha) {
    std::vector<double> gloss;
    gloss.reserve(readings.size());
    double diffuse = std::numeric_limits<double>::infinity();
    for (const Reading& r : readings) {
        gloss.push_back(Lobes::gloss(alpha, r.light, r.detector));
        diffuse = std::min(diffuse, r.value);
    }
    Fit fit;
    fit.kd = std::max(diffuse * std::numbers::pi, 1e-6);
    fit.ks = 0.04;
    for (int step = 0; step < 16; ++step) {
        double aa = 0.0, ab = 0.0, bb = 0.0, ar = 0.0, br = 0.0, error = 0.0;
        for (std::size_t n = 0; n < readings.size(); ++n) {
            const double f = fit.kd / std::numbers::pi + fit.ks * gloss[n];
            const double r = std::log(readings[n].value / f);
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
        fit.error = error / static_cast<double>(readings.size());
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

Lobes fitChannel(const std::vector<Reading>& readings) {
    constexpr int kCoarse = 40;
    double best_log = 0.0;
    Fit best;
    const double low = std::log(kLeastAlpha);
    const double step = -low / (kCoarse - 1);
    for (int i = 0; i < kCoarse; ++i) {
        const Fit fit = fitAt(readings, std::exp(low + i * step));
        if (fit.error < best.error) {
            best = fit;
            best_log = low + i * step;
        }
    }
    // Halving steps around the best.
    double s = step;
    for (int halving = 0; halving < 7; ++halving) {
        s *= 0.5;
        for (const double candidate : {best_log - s, best_log + s}) {
            if (candidate < low || candidate > 0.0) continue;
            const Fit fit = fitAt(readings, std::exp(candidate));
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

double Lobes::gloss(double alpha, const glm::dvec3& light, const glm::dvec3& detector) {
    const glm::dvec3 h = glm::normalize(light + detector);
    const double a2 = alpha * alpha;
    const double k = a2 * h.z * h.z + h.x * h.x + h.y * h.y;
    const auto stretch = [a2](const glm::dvec3& w) { return std::sqrt(w.z * w.z + a2 * (w.x * w.x + w.y * w.y)); };
    const double c = std::clamp(0.5 * (glm::dot(h, light) + glm::dot(h, detector)), 0.0, 1.0);
    const double t = std::sqrt(1.0 - (1.0 - c * c) / (kEta * kEta));
    const double parallel = (kEta * c - t) / (kEta * c + t);
    const double perpendicular = (c - kEta * t) / (c + kEta * t);
    const double fresnel = 0.5 * (parallel * parallel + perpendicular * perpendicular) / kF0;
    const double visibility = 0.5 / std::max(stretch(detector) * light.z + stretch(light) * detector.z, 1e-12);
    return fresnel * a2 / (std::numbers::pi * k * k) * visibility;
}

double Lobes::eval(const glm::dvec3& light, const glm::dvec3& detector) const {
    return kd / std::numbers::pi + ks * gloss(alpha, light, detector);
}

std::array<Lobes, 3> fitLobes(const BrdfScan& scan) {
    // A subset of the readings of a fine scan is sufficient.
    const std::size_t step_a = std::max<std::size_t>(1, scan.azimuths.size() / 18);
    const std::size_t step_p = std::max<std::size_t>(1, scan.polars.size() / 45);
    constexpr double kGrazing = 85.0 * std::numbers::pi / 180.0;  // beyond, measurements are unreliable
    std::array<Lobes, 3> lobes;
    for (int c = 0; c < 3; ++c) {
        float peak = 0.0f;
        for (const Color& v : scan.values) peak = std::max(peak, v[c]);
        std::vector<Reading> readings;
        for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
            const double ti = scan.incidences[i];
            for (std::size_t a = 0; a < scan.azimuths.size(); a += step_a) {
                for (std::size_t p = 0; p < scan.polars.size(); p += step_p) {
                    const double tp = scan.polars[p];
                    if (tp > kGrazing) continue;
                    const double v = static_cast<double>(scan.values[scan.index(i, a, p)][c]);
                    const double phi = scan.azimuths[a];
                    readings.push_back({{std::sin(ti), 0.0, std::cos(ti)},
                                        {std::sin(tp) * std::cos(phi), std::sin(tp) * std::sin(phi), std::cos(tp)},
                                        std::max({v, 1e-5 * static_cast<double>(peak), 1e-7})});
                }
            }
        }
        lobes[static_cast<std::size_t>(c)] = fitChannel(readings);
    }
    return lobes;
}

}  // namespace stratum::shade
