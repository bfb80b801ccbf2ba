#include "voxelize/grid/voxel_choice.h"

#include "base/error.h"
#include "base/human_text.h"
#include "base/text.h"
#include "voxelize/beads/estimate.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/print_columns.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace stratum::voxelize {
namespace {

constexpr int kMostVoxelsPerLayer = 64;
constexpr int kMostWithinBudget = 16;
// The upper nodes of however small a grid: a part across the origin has eight, of 32^3 pointers each.
constexpr double kBytesOfTree = 2.2e6;
// Of a leaf: masks that the flood keeps for a leaf while it runs, and leaves that it visits without keeping them.
constexpr double kFloodShare = 0.35;
// Voxels a layer of the culled build that finer ones are scaled from.
constexpr int kScaledFrom = 2;

}  // namespace

int voxelsPerLayerForTolerance(double layer_height, double tolerance) {
    if (!(std::isfinite(tolerance) && tolerance > 0))
        throw UsageError(fmt::format("--tolerance {}: expected a number of mm above 0, e.g. 0.02", tolerance));
    const double count = std::ceil(kLargestMissVoxels * layer_height / tolerance - 1e-9);
    if (count > kMostVoxelsPerLayer)
        throw UsageError(
            fmt::format("--tolerance {:g} mm needs {:.0f} voxels a layer of {:g} mm, at most {} are made; "
                        "the finest tolerance is {:g} mm",
                        tolerance, count, layer_height, kMostVoxelsPerLayer,
                        kLargestMissVoxels * layer_height / kMostVoxelsPerLayer));
    return std::max(kFewestVoxelsPerLayer, static_cast<int>(count));
}

int voxelsPerLayerForPixel(double layer_height, double pixel) {
    const double count = std::ceil(kVoxelsPerPixel * layer_height / pixel - 1e-9);
    return static_cast<int>(std::clamp<double>(count, kFewestForPixels, kMostForPixels));
}

double estimateBytes(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
                     Interior interior, double bytes_per_leaf) {
    if (interior == Interior::cull) {
        Lattice coarse = lattice;
        coarse.voxel_size = std::max(lattice.voxel_size, lattice.layer_height / kScaledFrom);
        VoxelizeOptions options;
        options.interior = Interior::cull;
        const auto leaves = static_cast<double>(voxelize(toolpath, selection, coarse, options)->tree().leafCount());
        const double finer = coarse.voxel_size / lattice.voxel_size;
        return leaves * finer * finer * (bytes_per_leaf + kFloodShare * kBytesPerLeaf) + kBytesOfTree;
    }
    const LayerStack stack = stackLayers(toolpath, selection);
    const PrintColumns columns(toolpath, stack, lattice);
    std::size_t leaves = 0;
    for (std::size_t c = 0; c < columns.size(); ++c)
        for (const LeafRange& range : columns.bounds(c))
            leaves += static_cast<std::size_t>(range.second - range.first) + 1;
    return static_cast<double>(leaves) * bytes_per_leaf + static_cast<double>(columns.bins().bytes()) + kBytesOfTree;
}

int voxelsPerLayerWithin(double budget, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                         const Lattice& any_size, Interior interior, double bytes_per_leaf) {
    static_assert(kScaledFrom == kFewestVoxelsPerLayer);
    Lattice lattice = any_size;
    lattice.voxel_size = lattice.layer_height / kFewestVoxelsPerLayer;
    const double coarsest = estimateBytes(toolpath, selection, lattice, interior, bytes_per_leaf);
    if (coarsest > budget)
        throw UsageError(fmt::format(
            "--memory-budget: {} voxels a layer of {:g} mm take about {} already, and fewer lose parts of the "
            "print; give that much, fewer layers, features or grids{}",
            kFewestVoxelsPerLayer, lattice.layer_height, humanBytes(coarsest),
            interior == Interior::keep ? ", or --interior cull" : ""));
    int best = kFewestVoxelsPerLayer;
    for (int count = best + 1; count <= kMostWithinBudget; ++count) {
        const double finer = static_cast<double>(count) / kFewestVoxelsPerLayer;
        // A culled grid grows like a surface (see estimateBytes). A full grid grows at least as fast, up to a third
        // because of partly empty leaves; sizes that this bound excludes are not counted exactly.
        const double least = coarsest * finer * finer;
        if (least > (interior == Interior::cull ? 1 : 1.5) * budget) break;
        lattice.voxel_size = lattice.layer_height / count;
        if (interior == Interior::keep &&
            estimateBytes(toolpath, selection, lattice, interior, bytes_per_leaf) > budget)
            break;
        best = count;
    }
    return best;
}

double parseSize(std::string_view text) {
    double value = 0;
    const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
    std::string suffix;
    for (const char* p = end; p != text.data() + text.size(); ++p)
        if (*p != ' ') suffix += lowerCase(*p);
    if (suffix.ends_with('b')) suffix.pop_back();
    // SI, and with an i the binary ones of IEC 80000-13.
    const bool binary = suffix.size() == 2 && suffix.ends_with('i');
    if (binary) suffix.pop_back();
    constexpr std::string_view kPrefixes = "kmgt";
    const std::size_t power = suffix.size() == 1 ? kPrefixes.find(suffix[0]) : std::string_view::npos;
    const bool known = suffix.empty() ? !binary : power != std::string_view::npos;
    if (error != std::errc{} || !(value > 0) || !std::isfinite(value) || !known)
        throw UsageError(fmt::format("{}: expected a size such as 800MB, 4GB or 4GiB", text));
    return suffix.empty() ? value : value * std::pow(binary ? 1024.0 : 1000.0, static_cast<double>(power + 1));
}

}  // namespace stratum::voxelize
