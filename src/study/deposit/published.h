// Figures of other people's measurements, with their sources.
#pragma once

#include <array>

namespace stratum::study {

/// Ra of flat PLA surfaces across the lines of printing ("Ra-90"), um, of three runs a layer height, each at other
/// speeds and infills. Source: "Surface Roughness Modeling of Material Extrusion PLA Flat Surfaces", Int. J. Polymer
/// Science 2023, 8844626, table 1.
struct PublishedRoughness {
    double layer_mm;
    std::array<double, 3> ra_um;
};
inline constexpr std::array<PublishedRoughness, 3> kPublishedRoughness{
    {{0.1, {12.04, 13.02, 14.08}}, {0.15, {15.01, 15.35, 16.22}}, {0.2, {15.31, 17.24, 18.14}}}};
inline constexpr const char* kRoughnessSource = "Int. J. Polymer Science 2023, 8844626, table 1, \"Ra-90\"";

/// Ra (um) against the extruded volume, in parts of what the slicer asks for; mean and spread. Their layer height is
/// not in the figure's caption, so only the change is compared. Source: Scientific Reports 2025,
/// s41598-025-26253-0, fig. 14.
struct PublishedFlow {
    double flow;
    double ra_um, spread_um;
};
inline constexpr std::array<PublishedFlow, 2> kPublishedFlow{{{1.0, 7.82, 1.01}, {1.1, 6.88, 0.15}}};
inline constexpr const char* kFlowSource = "Scientific Reports 2025, s41598-025-26253-0, fig. 14";

/// What VOLCO (github FullControlXYZ/volco) makes of the tile, mm^3, with the settings of its examples and voxels of
/// 0.05 mm, parallel and crossed: measured by bench/volco.py on 2026-11-22.
inline constexpr double kVolcoParallel = 19.542, kVolcoCrossed = 19.528;

}  // namespace stratum::study
