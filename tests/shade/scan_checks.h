// Scans of a known surface, and the text files that a scatterometer would write of it.
#pragma once

#include "shade/brdf/brdf_scan.h"
#include "shade/brdf/lobe_fit.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace stratum::test {

inline constexpr double kRadians = std::numbers::pi / 180.0;

inline std::vector<double> radians(std::vector<double> degrees) {
    for (double& d : degrees) d *= kRadians;
    return degrees;
}

/// A plastic whose three channels differ in body and gloss; reciprocal.
inline shade::Color knownBrdf(const glm::dvec3& light, const glm::dvec3& detector) {
    const auto up = [](glm::dvec3 d) {
        d.z = std::max(d.z, 1e-4);
        return glm::normalize(d);
    };
    const glm::dvec3 l = up(light);
    const glm::dvec3 d = up(detector);
    const auto body = [&](double kd) {
        return kd * (1.0 - 0.4 * std::pow(1.0 - l.z, 3.0)) * (1.0 - 0.4 * std::pow(1.0 - d.z, 3.0));
    };
    const shade::GlossyPair pair(l, d);
    return shade::Color(shade::Lobes{body(0.6), 0.04, 0.20}.eval(pair), shade::Lobes{body(0.3), 0.05, 0.25}.eval(pair),
                        shade::Lobes{body(0.05), 0.04, 0.30}.eval(pair));
}

inline shade::BrdfScan knownScan(const std::vector<double>& degrees, std::size_t azimuths = 37,
                                 std::size_t polars = 91) {
    return shade::makeScan(knownBrdf, radians(degrees), shade::evenAngles(0.0, std::numbers::pi, azimuths),
                           shade::evenAngles(0.0, 0.5 * std::numbers::pi, polars));
}

inline std::string joined(const std::vector<double>& values, const char* separator = "\t") {
    std::string text;
    for (const double v : values) {
        if (!text.empty()) text += separator;
        text += fmt::format("{:.9g}", v);
    }
    text += '\n';
    return text;
}

/// The known surface in Mini-Diff text; the light's azimuth is `origin` degrees, a multiple of 90.
inline std::string miniDiffText(double origin, const std::string& line_end = "\n", double tis = -1.0) {
    std::vector<double> azimuths, radials;
    for (int a = 0; a <= 360; a += 10) azimuths.push_back(a);
    for (int r = 0; r <= 90; r += 2) radials.push_back(r);
    std::string text = "# by hand\nModel #: known\nSource\tMeasured\n";
    text += fmt::format("ScatterAzimuth\t{}\n", azimuths.size()) + joined(azimuths);
    text += fmt::format("ScatterRadial\t{}\n", radials.size()) + joined(radials) + "DataBegin\n";
    for (const double aoi : {0.0, 20.0, 40.0, 60.0}) {
        for (int c = 0; c < 3; ++c) {
            text += fmt::format("\nAOI {:g}\nPOI 0\nSide Front\nWavelength {}\nScatterType BRDF\n", aoi, 630 - 90 * c);
            if (tis >= 0.0) text += fmt::format("TIS {}\n", tis);
            const glm::dvec3 light(std::sin(aoi * kRadians), 0.0, std::cos(aoi * kRadians));
            for (const double a : azimuths) {
                std::vector<double> row;
                for (const double r : radials) {
                    const double phi = (a - origin) * kRadians;
                    row.push_back(
                        double(knownBrdf(light, {std::sin(r * kRadians) * std::cos(phi),
                                                 std::sin(r * kRadians) * std::sin(phi), std::cos(r * kRadians)})[c]));
                }
                text += joined(row);
            }
        }
    }
    text += "DataEnd\n";
    if (line_end == "\n") return text;
    std::string other;
    for (const char c : text) {
        if (c == '\n')
            other += line_end;
        else
            other += c;
    }
    return other;
}

/// Largest relative difference between a folded scan and the known surface, over polar angles up to `most` degrees.
inline double worst(const shade::BrdfScan& scan, double most = 80.0) {
    double largest = 0.0;
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const glm::dvec3 light(std::sin(scan.incidences[i]), 0.0, std::cos(scan.incidences[i]));
        for (std::size_t a = 0; a < scan.azimuths.size(); ++a) {
            for (std::size_t p = 0; p < scan.polars.size(); ++p) {
                const double polar = scan.polars[p];
                if (polar > most * kRadians) continue;
                const double phi = scan.azimuths[a];
                const shade::Color truth = knownBrdf(
                    light, {std::sin(polar) * std::cos(phi), std::sin(polar) * std::sin(phi), std::cos(polar)});
                for (int c = 0; c < 3; ++c)
                    largest =
                        std::max(largest, double(std::abs(scan.values[scan.index(i, a, p)][c] / truth[c] - 1.0f)));
            }
        }
    }
    return largest;
}

}  // namespace stratum::test
