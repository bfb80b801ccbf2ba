#include "shade/measured/scan_interpolant.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr double kHighest = 89.9 * std::numbers::pi / 180.0;

glm::dvec3 directionOf(double polar, double azimuth) {
    return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

// Of vectors that are no longer than 2: no care for overflow is needed.
double lengthOf(double x, double y) { return std::sqrt(x * x + y * y); }

/// Maps a projected direction when the mirror point moves.
/// @param m, n  where the mirror points of both incidences lie along x: at minus their sines
/// @param at    the direction; polar and azimuth are its angles
void carry(double m, double n, const glm::dvec3& at, double& polar, double& azimuth) {
    if (m == n) return;
    const double x = at.x - m;
    const double y = at.y;
    const double r = lengthOf(x, y);
    double px = n;
    double py = 0.0;
    if (r > 0.0) {
        const double ux = x / r;
        const double uy = y / r;
        // Length of the ray from the mirror point to the rim, and how far along it the direction lies.
        const double b = -ux * m;
        const double rim = b + std::sqrt(std::max(b * b - m * m + 1.0, 0.0));
        const double share = rim > 0.0 ? std::min(r / rim, 1.0) : 0.0;
        px = n + share * (m + rim * ux - n);
        py = share * rim * uy;
    }
    polar = std::asin(std::min(lengthOf(px, py), 1.0));
    azimuth = std::atan2(py, px);
}

}  // namespace

ScanInterpolant::ScanInterpolant(const BrdfScan& scan) : scan_(scan), lobes_(fitLobes(scan)) {
    for (const double i : scan.incidences) sines_.push_back(std::sin(i));
    glm::dvec3 least(0.0);
    for (const Color& v : scan.values) least = glm::max(least, glm::dvec3(v));
    least = glm::max(least * 1e-5, glm::dvec3(1e-7));  // a floor for the logarithm, below that of scatterometers
    residuals_.reserve(scan.values.size());
    std::size_t n = 0;
    for (const double i : scan.incidences) {
        for (const double a : scan.azimuths) {
            for (const double p : scan.polars) {
                const glm::dvec3 value = glm::max(glm::dvec3(scan.values[n++]), least);
                glm::dvec3 r;
                const GlossyPair pair(directionOf(i, 0.0), directionOf(std::min(p, kHighest), a));
                for (int c = 0; c < 3; ++c) r[c] = std::log(value[c] / lobes_[static_cast<std::size_t>(c)].eval(pair));
                residuals_.push_back(r);
            }
        }
    }
    scan_.values = {};
}

glm::dvec3 ScanInterpolant::residual(std::size_t incidence, double polar, double azimuth) const {
    const NodePlace a = placeAmong(scan_.azimuths, std::abs(azimuth));
    const NodePlace p = placeAmong(scan_.polars, polar);
    const auto ring = [&](std::size_t i) {
        const glm::dvec3* r = &residuals_[scan_.index(incidence, i, p.low)];
        return (1.0 - p.weight) * r[0] + p.weight * r[1];
    };
    return a.weight > 0.0 ? (1.0 - a.weight) * ring(a.low) + a.weight * ring(a.low + 1) : ring(a.low);
}

glm::dvec3 ScanInterpolant::oneWay(double incidence, double polar, double azimuth) const {
    glm::dvec3 result;
    const glm::dvec3 light = directionOf(incidence, 0.0);
    const glm::dvec3 detector = directionOf(polar, azimuth);
    const GlossyPair pair(light, detector);
    for (int c = 0; c < 3; ++c) result[c] = std::log(lobes_[static_cast<std::size_t>(c)].eval(pair));
    const auto carried = [&](std::size_t i) {
        double p = polar;
        double a = azimuth;
        carry(-light.x, -sines_[i], detector, p, a);
        return residual(i, p, a);
    };
    const NodePlace place = placeAmong(scan_.incidences, incidence);
    if (place.weight < 1.0) result += (1.0 - place.weight) * carried(place.low);
    if (place.weight > 0.0) result += place.weight * carried(place.low + 1);
    return result;
}

double ScanInterpolant::distanceToMeasured(double incidence) const {
    constexpr double kOutside = 3.0;
    if (incidence > scan_.incidences.back()) return kOutside * (incidence - scan_.incidences.back());
    double nearest = std::numeric_limits<double>::infinity();
    for (const double measured : scan_.incidences) nearest = std::min(nearest, std::abs(incidence - measured));
    return nearest;
}

glm::dvec3 ScanInterpolant::eval(const glm::dvec3& light, const glm::dvec3& detector) const {
    const auto polarOf = [](const glm::dvec3& d) {
        return std::min(std::atan2(lengthOf(d.x, d.y), std::max(d.z, 0.0)), kHighest);
    };
    const double ti = polarOf(light);
    const double to = polarOf(detector);
    // Azimuth around the normal; arbitrary for directions along it.
    const double cross = light.x * detector.y - light.y * detector.x;
    const double azimuth = std::abs(std::atan2(cross, light.x * detector.x + light.y * detector.y));
    const double di = distanceToMeasured(ti);
    const double far = distanceToMeasured(to);
    const double sum = di * di + far * far;
    const double share = sum > 1e-18 ? far * far / sum : 0.5;
    glm::dvec3 log(0.0);
    if (share > 0.0) log += share * oneWay(ti, to, azimuth);
    if (share < 1.0) log += (1.0 - share) * oneWay(to, ti, azimuth);
    return glm::exp(log);
}

}  // namespace stratum::shade
