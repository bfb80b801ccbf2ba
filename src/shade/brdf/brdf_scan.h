// What a scatterometer writes: a BRDF at a few angles of incidence, densely over the hemisphere of detection.
#pragma once

#include "shade/color.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// No instrument turns its lamp in finer steps than degrees; what is made of a scan takes time for each.
inline constexpr std::size_t kMostIncidences = 180;

/// A BRDF in 1/sr, sampled on incidences x azimuths x polars. Angles in radians, each list strictly ascending.
/// Azimuth is the detector's, measured from that of the light: 0 is back towards the light, pi the mirror side.
struct BrdfScan {
    std::vector<double> incidences;  ///< of the light to the normal, [0, pi/2)
    std::vector<double> azimuths;    ///< [0, 2 pi]; after foldScan [0, pi]
    std::vector<double> polars;      ///< of the detector to the normal, [0, pi/2]
    std::vector<Color> values;       ///< polar fastest, then azimuth, then incidence
    std::vector<std::string> notes;  ///< what the file says of itself and what the reader found odd, for reports

    std::size_t index(std::size_t incidence, std::size_t azimuth, std::size_t polar) const {
        return (incidence * azimuths.size() + azimuth) * polars.size() + polar;
    }
    /// Throws InputError that names the file unless there are enough angles in order, not more than kMostIncidences,
    /// and all values are numbers.
    void check(std::string_view name) const;
};

/// Where a value lies among ascending nodes: between nodes `low` and `low + 1` at `weight`; the ends are clamped.
struct NodePlace {
    std::size_t low;
    double weight;
};
NodePlace placeAmong(const std::vector<double>& nodes, double value);

/// Bilinear value at one measured incidence; azimuth is round.
glm::dvec3 scanAt(const BrdfScan& scan, std::size_t incidence, double azimuth, double polar);

/// The same scan over azimuths [0, pi]: both sides of the plane of incidence averaged, as for any surface without a
/// grain. Half scans are taken as they are. Negative readings become 0.
BrdfScan foldScan(const BrdfScan& scan);

/// Where, among quarter turns, the mirror side lies in a scan whose azimuths count from somewhere else: the azimuth, in
/// radians, around which light is mirrored. Notes what it found. Without any oblique incidence: pi.
double findMirrorAzimuth(const BrdfScan& scan);

/// Turns the azimuths so that `mirror` becomes pi.
BrdfScan turnScan(const BrdfScan& scan, double mirror);

/// Hemispherical reflectance of one measured incidence: integral of f cos over the detector's hemisphere.
Color scanAlbedo(const BrdfScan& scan, std::size_t incidence);

/// A scan of a function of unit vectors towards light and detector, on the grid of these angles (radians).
BrdfScan makeScan(const std::function<Color(const glm::dvec3& light, const glm::dvec3& detector)>& brdf,
                  std::vector<double> incidences, std::vector<double> azimuths, std::vector<double> polars);

/// `count` even steps from `first` to `last`, both included. Radians.
std::vector<double> evenAngles(double first, double last, std::size_t count);

}  // namespace stratum::shade
