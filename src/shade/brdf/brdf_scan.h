// Scatterometer data: a BRDF at a few angles of incidence, sampled densely over the hemisphere of detection.
#pragma once

#include "shade/color.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// Limit of incidences: instruments have steps of degrees, and interpolants take time for each.
inline constexpr std::size_t kMostIncidences = 180;

/// A BRDF in 1/sr, sampled on incidences x azimuths x polars. Angles in radians, each list strictly ascending.
/// Azimuth is the detector's, measured from that of the light: 0 is back towards the light, pi the mirror side.
struct BrdfScan {
    std::vector<double> incidences;  ///< of the light to the normal, [0, pi/2)
    std::vector<double> azimuths;    ///< [0, 2 pi]; after foldScan [0, pi]
    std::vector<double> polars;      ///< of the detector to the normal, [0, pi/2]
    std::vector<Color> values;       ///< polar fastest, then azimuth, then incidence
    std::vector<std::string> notes;  ///< the file's statements and the reader's remarks, for reports

    std::size_t index(std::size_t incidence, std::size_t azimuth, std::size_t polar) const {
        return (incidence * azimuths.size() + azimuth) * polars.size() + polar;
    }
    /// Appends readings of three channels. Throws InputError that names the file unless they are as many.
    /// @param color  of one reading of each
    void append(const std::vector<double>& first, const std::vector<double>& second, const std::vector<double>& third,
                std::string_view name, Color (*color)(double, double, double));
    /// Throws InputError that names the file unless there are enough angles in order, not more than kMostIncidences.
    void checkAngles(std::string_view name) const;
    /// The same, and that there is one value for each of their combinations, all of them numbers.
    void check(std::string_view name) const;
};

/// The interval of a value among ascending nodes: between nodes `low` and `low + 1` at `weight`; clamped at the ends.
struct NodePlace {
    std::size_t low;
    double weight;
};
NodePlace placeAmong(const std::vector<double>& nodes, double value);

/// Bilinear value at one measured incidence; azimuth is periodic.
glm::dvec3 scanAt(const BrdfScan& scan, std::size_t incidence, double azimuth, double polar);

/// The same scan over azimuths [0, pi]: the mean of both sides of the plane of incidence, assuming isotropy. Half scans
/// are not changed. Negative readings become 0.
BrdfScan foldScan(const BrdfScan& scan);

/// The azimuth of the mirror direction, in radians, a multiple of a quarter turn, for scans with an unknown origin of
/// azimuths. Adds a note of the result. pi if there is no oblique incidence.
double findMirrorAzimuth(const BrdfScan& scan);

/// Shifts the azimuths so that `mirror` becomes pi.
BrdfScan turnScan(const BrdfScan& scan, double mirror);

/// Hemispherical reflectance of one measured incidence: integral of f cos over the detector's hemisphere.
Color scanAlbedo(const BrdfScan& scan, std::size_t incidence);

/// A scan of a function of unit vectors towards light and detector, on the grid of these angles (radians).
BrdfScan makeScan(const std::function<Color(const glm::dvec3& light, const glm::dvec3& detector)>& brdf,
                  std::vector<double> incidences, std::vector<double> azimuths, std::vector<double> polars);

/// `count` even steps from `first` to `last`, both included. Radians.
std::vector<double> evenAngles(double first, double last, std::size_t count);

}  // namespace stratum::shade
