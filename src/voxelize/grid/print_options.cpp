#include "voxelize/grid/print_options.h"

#include "base/error.h"
#include "base/human_text.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::voxelize {

bool choosesVoxels(const PrintOptions& options) {
    return options.lattice.voxel_size || options.lattice.voxels_per_layer || options.tolerance ||
           !options.memory_budget.empty();
}

Selection selectionOf(const PrintOptions& options, const gcode::Toolpath& toolpath) {
    Selection selection;
    if (!options.layers.empty()) parseLayers(options.layers, selection);
    if (!options.features.empty()) parseFeatures(options.features, selection);
    for (const std::string& object : options.objects) chooseObject(object, toolpath, selection);
    for (const std::uint8_t tool : options.tools) chooseTool(tool, toolpath, selection);
    return selection;
}

std::string describeSelection(const PrintOptions& options) {
    std::string text;
    const auto note = [&text](const char* what, const std::string& value) {
        if (!value.empty()) text += fmt::format("{}{} {}", text.empty() ? "" : "; ", what, value);
    };
    note("layers", options.layers);
    if (options.features != "all") note("features", options.features);
    for (const std::string& object : options.objects) note("object", object);
    for (const std::uint8_t tool : options.tools) note("tool", std::to_string(tool));
    return text;
}

Lattice latticeFor(const PrintOptions& options, const gcode::Toolpath& toolpath,
                   const std::vector<std::uint32_t>& selection, const Bounds& bounds, Interior interior, double pixel,
                   double bytes_per_leaf) {
    LatticeRequest request = options.lattice;
    // A culled print keeps less than half of its leaves, unless it is hollow.
    request.bytes_per_leaf =
        interior == Interior::cull ? std::max(0.5 * bytes_per_leaf, kBytesPerLeaf) : bytes_per_leaf;
    request.pixel = pixel;
    std::string why;
    if (options.voxel_auto || options.tolerance || !options.memory_budget.empty()) {
        request.voxels_per_layer = kFewestVoxelsPerLayer;
        const Lattice coarse = chooseLattice(toolpath, selection, bounds, request);
        if (options.voxel_auto) {
            request.voxels_per_layer = voxelsPerLayerForPixel(coarse.layer_height, pixel);
            why = fmt::format("; a pixel spans {:.3g} mm or more", pixel);
        } else if (options.tolerance) {
            request.voxels_per_layer = voxelsPerLayerForTolerance(coarse.layer_height, *options.tolerance);
            why = fmt::format("; errors of {:g} voxel at most stay within {:g} mm", kLargestMissVoxels,
                              *options.tolerance);
        } else {
            const double budget = parseSize(options.memory_budget);
            request.voxels_per_layer =
                voxelsPerLayerWithin(budget, toolpath, selection, coarse, interior, bytes_per_leaf);
            why = fmt::format("; the finest within {}", humanBytes(budget));
        }
    }
    Lattice lattice = chooseLattice(toolpath, selection, bounds, request);
    lattice.reason += why;
    // With two voxels a layer or more only details thinner than a layer are lost.
    if (lattice.voxel_size * kFewestVoxelsPerLayer > 1.01 * lattice.layer_height) {
        const double lost = lostShare(toolpath, selection, lattice);
        const double per_layer = lattice.layer_height / lattice.voxel_size;
        if (lost > 0 || per_layer < 1.01)
            lattice.warning =
                fmt::format("{:.2g} voxel{} a layer of {:g} mm: {}layer lines need {} a layer, {:g} mm", per_layer,
                            per_layer < 1.01 ? "" : "s", lattice.layer_height,
                            lost > 0 ? fmt::format("{:.1f} % of a sample of beads have no solid in their middle; ",
                                                   std::max(100 * lost, 0.1))
                                     : "",
                            kFewestVoxelsPerLayer, lattice.layer_height / kFewestVoxelsPerLayer);
    }
    return lattice;
}

}  // namespace stratum::voxelize
