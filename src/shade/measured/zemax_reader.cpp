#include "shade/measured/text_readers.h"

#include "shade/angles.h"
#include "shade/measured/scan_text.h"
#include "shade/primaries.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostZemaxAngles = 2000;
constexpr std::size_t kMostSamples = std::size_t{1} << 26;

struct ZemaxFile {
    std::vector<double> rotations, incidences, azimuths, radials;  // degrees
    bool plane_symmetrical = false;
    bool xyz = false;
    std::array<std::vector<double>, 3> channels;  // radial fastest, azimuth, incidence
};

std::vector<double> angles(ScanText& text, std::string_view value, std::string_view what) {
    return text.numbers(countOf(text, value, what, 1, kMostZemaxAngles), what);
}

/// The matrices of one channel: for each rotation and incidence a TIS and azimuths x radials. Only the first rotation
/// of the sample is kept.
std::vector<double> readChannel(ScanText& text, const ZemaxFile& file) {
    std::vector<double> readings;
    const std::size_t count = file.azimuths.size() * file.radials.size();
    for (std::size_t rotation = 0; rotation < file.rotations.size(); ++rotation) {
        for (const double aoi : file.incidences) {
            const Keyword tis = splitKeyword(text.expect("TIS and a number"));
            if (tis.key != "TIS") text.fail(fmt::format("'{}': expected TIS", tis.key.substr(0, 40)));
            const std::vector<double> block = text.numbers(count, fmt::format("readings of AOI {:g}", aoi));
            if (rotation == 0) readings.insert(readings.end(), block.begin(), block.end());
        }
    }
    return readings;
}

ZemaxFile readFile(ScanText& text) {
    ZemaxFile file;
    std::size_t channel = 0;
    std::string_view line;
    while (text.next(line)) {
        const Keyword k = splitKeyword(line);
        if (k.key == "Symmetry") {
            file.plane_symmetrical = k.value.starts_with("Plane");
        } else if (k.key == "SpectralContent") {
            file.xyz = k.value == "XYZ";
        } else if (k.key == "ScatterType") {
            if (k.value != "BRDF") text.fail(fmt::format("ScatterType {}: only BRDF can be used", k.value));
        } else if (k.key == "SampleRotation") {
            file.rotations = angles(text, k.value, "sample rotations");
        } else if (k.key == "AngleOfIncidence") {
            file.incidences = angles(text, k.value, "angles of incidence");
        } else if (k.key == "ScatterAzimuth") {
            file.azimuths = angles(text, k.value, "azimuths");
        } else if (k.key == "ScatterRadial") {
            file.radials = angles(text, k.value, "radial angles");
        } else if (k.key == "DataBegin") {
            if (file.incidences.empty() || file.azimuths.empty() || file.radials.size() < 2)
                text.fail("DataBegin before AngleOfIncidence, ScatterAzimuth and ScatterRadial");
            if (file.rotations.empty()) file.rotations = {0.0};
            if (file.rotations.size() * file.incidences.size() * file.azimuths.size() >
                kMostSamples / file.radials.size())
                text.fail(fmt::format("more than {} readings; this is no scan of a surface", kMostSamples));
            if (channel >= 3) text.fail("more than three channels");
            file.channels[channel++] = readChannel(text, file);
        }
    }
    if (channel != (file.xyz ? 3u : 1u))
        text.fail(fmt::format("{} channels of data; expected {}", channel, file.xyz ? 3 : 1));
    return file;
}

}  // namespace

bool isZemax(std::string_view text) {
    const std::string_view head = text.substr(0, 65536);
    return head.find("ScatterRadial") != std::string_view::npos &&
           head.find("AngleOfIncidence") != std::string_view::npos;
}

BrdfScan readZemax(std::string_view bytes, std::string_view name) {
    ScanText text(bytes, name);
    const ZemaxFile file = readFile(text);

    // About the mirror direction, as the file has it; scanAt interpolates in it.
    BrdfScan about;
    for (const double i : file.incidences) about.incidences.push_back(i * kRadians);
    for (const double a : file.azimuths) about.azimuths.push_back(a * kRadians);
    for (const double r : file.radials) about.polars.push_back(r * kRadians);
    const std::array<std::vector<double>, 3>& c = file.channels;
    if (file.xyz)
        about.append(c[0], c[1], c[2], name, [](double x, double y, double z) { return Color(fromXyz(x, y, z)); });
    else
        for (const double value : c[0]) about.values.emplace_back(static_cast<float>(value));
    // Radials run to 180 degrees: from a grazing mirror direction across the hemisphere.
    BrdfScan checked = about;
    for (double& p : checked.polars) p *= 0.5;
    checked.check(name);

    BrdfScan scan;
    scan.incidences = about.incidences;
    scan.azimuths = evenAngles(0.0, std::numbers::pi, 73);
    scan.polars = evenAngles(0.0, 0.5 * std::numbers::pi, 91);
    for (const std::string& comment : text.comments()) scan.notes.push_back(comment);
    scan.notes.emplace_back("resampled from angles about the mirror direction");
    if (file.rotations.size() > 1) scan.notes.emplace_back("only the first rotation of the sample was taken");
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const double ti = scan.incidences[i];
        // The light is at azimuth 0, so its mirror direction leans to -x.
        const glm::dvec3 mirror(-std::sin(ti), 0.0, std::cos(ti));
        const glm::dvec3 to_normal(std::cos(ti), 0.0, std::sin(ti));  // perpendicular to it, towards the normal
        for (const double a : scan.azimuths) {
            for (const double p : scan.polars) {
                const glm::dvec3 d(std::sin(p) * std::cos(a), std::sin(p) * std::sin(a), std::cos(p));
                const double along = glm::dot(d, to_normal);
                const double radial = std::atan2(std::hypot(along, d.y), glm::dot(d, mirror));
                double azimuth = std::atan2(d.y, along);
                if (file.plane_symmetrical) azimuth = std::abs(azimuth);
                const glm::dvec3 one = scanAt(about, i, azimuth, radial);
                const glm::dvec3 other = file.plane_symmetrical ? one : scanAt(about, i, -azimuth, radial);
                scan.values.emplace_back(0.5 * (one + other));
            }
        }
    }
    scan.check(name);
    return scan;
}

}  // namespace stratum::shade
