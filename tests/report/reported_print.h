// Prints made by hand and their reports, for the tests of this room.
#pragma once

#include "report/print_report.h"
#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <optional>
#include <string_view>

namespace stratum::test {

/// Layers of one height, at `voxels` a layer.
inline voxelize::Lattice layeredLattice(double height, int voxels) {
    voxelize::Lattice lattice;
    lattice.voxel_size = height / voxels;
    lattice.layer_height = height;
    return lattice;
}

inline report::PrintReport reportOfAll(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice,
                                       const report::ReportOptions& options = {}) {
    const auto beads = allBeads(toolpath);
    const auto grid = voxelize::voxelize(toolpath, beads, lattice);
    return report::makeReport(*grid, toolpath, beads, lattice, std::nullopt, options);
}

inline double numberOf(const report::PrintReport& report, std::string_view key) {
    const report::Number* number = report.find(key);
    if (number == nullptr) {
        ADD_FAILURE() << key << " is not in the report";
        return 0;
    }
    return std::get<double>(number->value);
}

inline double detailOf(const report::PrintReport& report, std::string_view key, std::string_view detail) {
    if (const report::Number* number = report.find(key))
        for (const auto& [name, value] : number->details)
            if (name == detail) return std::get<double>(value);
    ADD_FAILURE() << key << " has no " << detail;
    return 0;
}

/// Settled lines at the spacing of the slicers: layers that close to slabs. Edges are where the last beads' flats end,
/// and round beyond.
inline void addSlab(gcode::Toolpath& toolpath, double x0, double y0, double x1, int lines, double top, double width,
                    double height, std::uint32_t layer) {
    const double spacing = width - height * (1 - 0.78539816339744831);
    for (int n = 0; n < lines; ++n)
        addBead(toolpath, x0, y0 + n * spacing, top, x1, y0 + n * spacing, top, width, height, layer);
}

/// A ring of one bead a layer, about (0, 0).
inline gcode::Toolpath tube(double radius, double width, double height, int layers) {
    gcode::Toolpath toolpath;
    for (int n = 1; n <= layers; ++n)
        addArc(toolpath, 0, 0, radius, 0.1 * n, 6.2831853071795862, n * height, n * height, width, height,
               static_cast<std::uint32_t>(n));
    return toolpath;
}

}  // namespace stratum::test
