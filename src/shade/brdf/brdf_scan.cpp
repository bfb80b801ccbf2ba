#include "shade/brdf/brdf_scan.h"

#include "base/error.h"
#include "shade/angles.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

// 1/sr: a mirror that an instrument sees as a thousandth of a degree has less.
constexpr float kMostReading = 1e12f;

void checkAscending(const std::vector<double>& angles, double low, double high, std::string_view what,
                    std::string_view name) {
    for (std::size_t i = 0; i < angles.size(); ++i) {
        if (!(angles[i] >= low - 1e-9 && angles[i] <= high + 1e-9))
            throw InputError(fmt::format("{}: {} {} is {} degrees; expected {} to {}", name, what, i + 1,
                                         angles[i] * kDegrees, low * kDegrees, high * kDegrees));
        if (i > 0 && !(angles[i] > angles[i - 1]))
            throw InputError(fmt::format("{}: {} {} is {} degrees after {}; they must ascend", name, what, i + 1,
                                         angles[i] * kDegrees, angles[i - 1] * kDegrees));
    }
}

double wrapped(double azimuth) {
    const double turn = azimuth - 2.0 * std::numbers::pi * std::floor(azimuth / (2.0 * std::numbers::pi));
    return turn < 2.0 * std::numbers::pi ? turn : 0.0;
}

/// Integral weights of piecewise linear nodes.
std::vector<double> trapezoid(const std::vector<double>& nodes) {
    std::vector<double> weights(nodes.size(), 0.0);
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        weights[i] += 0.5 * (nodes[i + 1] - nodes[i]);
        weights[i + 1] += 0.5 * (nodes[i + 1] - nodes[i]);
    }
    return weights;
}

}  // namespace

void BrdfScan::append(const std::vector<double>& first, const std::vector<double>& second,
                      const std::vector<double>& third, std::string_view name, Color (*color)(double, double, double)) {
    if (first.size() != second.size() || first.size() != third.size())
        throw InputError(fmt::format("{}: {}, {} and {} readings for three channels; all need the same angles", name,
                                     first.size(), second.size(), third.size()));
    for (std::size_t n = 0; n < first.size(); ++n) values.push_back(color(first[n], second[n], third[n]));
}

void BrdfScan::checkAngles(std::string_view name) const {
    if (incidences.empty() || azimuths.empty() || polars.size() < 2)
        throw InputError(fmt::format("{}: {} incidences x {} azimuths x {} polar angles are too few for a BRDF", name,
                                     incidences.size(), azimuths.size(), polars.size()));
    if (incidences.size() > kMostIncidences)
        throw InputError(fmt::format("{}: {} angles of incidence; at most {} can be read", name, incidences.size(),
                                     kMostIncidences));
    checkAscending(incidences, 0.0, 89.0 / kDegrees, "angle of incidence", name);
    checkAscending(azimuths, 0.0, 2.0 * std::numbers::pi, "azimuth", name);
    checkAscending(polars, 0.0, 0.5 * std::numbers::pi, "polar angle", name);
}

void BrdfScan::check(std::string_view name) const {
    checkAngles(name);
    if (values.size() != incidences.size() * azimuths.size() * polars.size())
        throw InputError(
            fmt::format("{}: has {} readings for {} incidences x {} azimuths x {} polar angles; state the angles once, "
                        "before the readings",
                        name, values.size(), incidences.size(), azimuths.size(), polars.size()));
    bool black = true;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!isFinite(values[n]) || maxComponent(glm::abs(values[n])) > kMostReading)
            throw InputError(fmt::format(
                "{}: the value at incidence {:g}, azimuth {:g}, polar angle {:g} degrees is no "
                "number in 1/sr",
                name, incidences[n / polars.size() / azimuths.size()] * kDegrees,
                azimuths[n / polars.size() % azimuths.size()] * kDegrees, polars[n % polars.size()] * kDegrees));
        black = black && !(maxComponent(values[n]) > 0.0f);
    }
    if (black) throw InputError(fmt::format("{}: reflects nothing at all; all values are 0 or less", name));
}

NodePlace placeAmong(const std::vector<double>& nodes, double value) {
    if (nodes.size() < 2 || !(value > nodes.front())) return {0, 0.0};
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), value);
    if (above == nodes.end()) return {nodes.size() - 2, 1.0};
    const auto low = static_cast<std::size_t>(above - nodes.begin()) - 1;
    return {low, (value - nodes[low]) / (nodes[low + 1] - nodes[low])};
}

glm::dvec3 scanAt(const BrdfScan& scan, std::size_t incidence, double azimuth, double polar) {
    const NodePlace p = placeAmong(scan.polars, polar);
    const auto ring = [&](std::size_t a) {
        const auto first = scan.index(incidence, a, p.low);
        return (1.0 - p.weight) * glm::dvec3(scan.values[first]) + p.weight * glm::dvec3(scan.values[first + 1]);
    };
    const std::vector<double>& nodes = scan.azimuths;
    // A half scan is mirrored; a full one is periodic.
    double phi = wrapped(azimuth);
    if (nodes.back() <= std::numbers::pi + 1e-4 && nodes.front() < 0.5 * std::numbers::pi) {
        phi = std::min(phi, 2.0 * std::numbers::pi - phi);
    } else if (phi < nodes.front() || phi > nodes.back()) {
        const double gap = nodes.front() + 2.0 * std::numbers::pi - nodes.back();
        const double into = phi > nodes.back() ? phi - nodes.back() : phi + 2.0 * std::numbers::pi - nodes.back();
        const double w = gap > 0.0 ? into / gap : 0.0;
        return (1.0 - w) * ring(nodes.size() - 1) + w * ring(0);
    }
    const NodePlace a = placeAmong(nodes, phi);
    return a.weight > 0.0 ? (1.0 - a.weight) * ring(a.low) + a.weight * ring(a.low + 1) : ring(a.low);
}

BrdfScan foldScan(const BrdfScan& scan) {
    BrdfScan folded{scan.incidences, {}, scan.polars, {}, scan.notes};
    for (const double a : scan.azimuths)
        folded.azimuths.push_back(std::min(wrapped(a), 2.0 * std::numbers::pi - wrapped(a)));
    std::sort(folded.azimuths.begin(), folded.azimuths.end());
    folded.azimuths.erase(
        std::unique(folded.azimuths.begin(), folded.azimuths.end(), [](double a, double b) { return b - a < 1e-6; }),
        folded.azimuths.end());
    std::size_t negative = 0;
    for (std::size_t i = 0; i < folded.incidences.size(); ++i) {
        for (const double azimuth : folded.azimuths) {
            for (const double polar : folded.polars) {
                const glm::dvec3 mean =
                    0.5 * (scanAt(scan, i, azimuth, polar) + scanAt(scan, i, 2.0 * std::numbers::pi - azimuth, polar));
                negative += std::min({mean.x, mean.y, mean.z}) < 0.0;
                folded.values.emplace_back(glm::max(mean, glm::dvec3(0.0)));
            }
        }
    }
    if (negative > 0) folded.notes.push_back(fmt::format("{} negative readings were taken as 0", negative));
    return folded;
}

double findMirrorAzimuth(const BrdfScan& scan) {
    double best = std::numbers::pi;
    double brightest = -1.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
        const double azimuth = 0.5 * std::numbers::pi * quarter;
        double sum = 0.0;
        for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
            if (scan.incidences[i] < 5.0 / kDegrees) continue;
            const glm::dvec3 v = scanAt(scan, i, azimuth, scan.incidences[i]);
            sum += v.x + v.y + v.z;
        }
        // In doubt pi, the project's own convention.
        if (sum > brightest * (1.0 + 1e-6) || (quarter == 2 && sum >= brightest * (1.0 - 1e-6))) {
            brightest = sum;
            best = azimuth;
        }
    }
    return brightest > 0.0 ? best : std::numbers::pi;
}

BrdfScan turnScan(const BrdfScan& scan, double mirror) {
    if (std::abs(mirror - std::numbers::pi) < 1e-9) return scan;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t a = 0; a < scan.azimuths.size(); ++a) {
        double turned = wrapped(scan.azimuths[a] - mirror + std::numbers::pi);
        if (turned > 2.0 * std::numbers::pi - 1e-9) turned = 0.0;
        order.emplace_back(turned, a);
    }
    std::sort(order.begin(), order.end());
    // 0 and 360 degrees are one direction: keep one of them.
    order.erase(std::unique(order.begin(), order.end(), [](auto a, auto b) { return b.first - a.first < 1e-9; }),
                order.end());
    BrdfScan turned{scan.incidences, {}, scan.polars, {}, scan.notes};
    for (const auto& entry : order) turned.azimuths.push_back(entry.first);
    for (std::size_t i = 0; i < scan.incidences.size(); ++i)
        for (const auto& entry : order)
            for (std::size_t p = 0; p < scan.polars.size(); ++p)
                turned.values.push_back(scan.values[scan.index(i, entry.second, p)]);
    return turned;
}

Color scanAlbedo(const BrdfScan& scan, std::size_t incidence) {
    BrdfScan one{{scan.incidences[incidence]}, scan.azimuths, scan.polars, {}, {}};
    const std::size_t count = scan.azimuths.size() * scan.polars.size();
    const auto first = scan.values.begin() + static_cast<std::ptrdiff_t>(incidence * count);
    one.values.assign(first, first + static_cast<std::ptrdiff_t>(count));
    const BrdfScan folded = foldScan(one);
    const std::vector<double> around = trapezoid(folded.azimuths);
    const std::vector<double> down = trapezoid(folded.polars);
    glm::dvec3 sum(0.0);
    for (std::size_t a = 0; a < folded.azimuths.size(); ++a)
        for (std::size_t p = 0; p < folded.polars.size(); ++p)
            sum += glm::dvec3(folded.values[folded.index(0, a, p)]) *
                   (2.0 * around[a] * down[p] * std::sin(folded.polars[p]) * std::cos(folded.polars[p]));
    return Color(sum);
}

BrdfScan makeScan(const std::function<Color(const glm::dvec3&, const glm::dvec3&)>& brdf,
                  std::vector<double> incidences, std::vector<double> azimuths, std::vector<double> polars) {
    BrdfScan scan{std::move(incidences), std::move(azimuths), std::move(polars), {}, {}};
    for (const double i : scan.incidences)
        for (const double a : scan.azimuths)
            for (const double p : scan.polars)
                scan.values.push_back(brdf({std::sin(i), 0.0, std::cos(i)},
                                           {std::sin(p) * std::cos(a), std::sin(p) * std::sin(a), std::cos(p)}));
    return scan;
}

std::vector<double> evenAngles(double first, double last, std::size_t count) {
    std::vector<double> angles;
    for (std::size_t i = 0; i < count; ++i)
        angles.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(count - 1));
    return angles;
}

}  // namespace stratum::shade
