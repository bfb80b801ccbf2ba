#include "mechanics/solid_elements.h"

#include "base/error.h"
#include "mechanics/chosen_cubes.h"
#include "mechanics/cube_beads.h"
#include "mechanics/cube_shares.h"
#include "voxelize/grid/solid_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stratum::mechanics {
namespace {

[[noreturn]] void refuse(double count, const SolidOptions& options, double edge) {
    // The number falls with the cube of the size; a tenth more for what that leaves out.
    const double fits = edge * std::cbrt(1.1 * count / static_cast<double>(options.most));
    throw UsageError(
        fmt::format("about {:.3g} elements of {:g} mm are more than the {} nodes that are allowed; choose --voxel-size "
                    "{:.2g} or more, fewer layers or features, or a higher --max-nodes",
                    count, edge, options.most, std::ceil(fits * 100) / 100));
}

}  // namespace

SolidElements solidElements(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            const voxelize::Lattice& lattice, const SolidOptions& options) {
    const double edge = lattice.voxel_size;
    if (lattice.layer_height / edge > kMostPerLayer)
        throw UsageError(
            fmt::format("elements of {:g} mm are less than a {:g}th of a layer of {:g} mm; choose --voxel-size "
                        "{:.2g} or more",
                        edge, kMostPerLayer, lattice.layer_height, lattice.layer_height / kMostPerLayer));
    // Beads overlap: the solid is less than what they hold, but not much.
    const double expected = voxelize::depositedVolume(toolpath, selection) / (edge * edge * edge);
    if (options.most > 0 && expected > 2.0 * static_cast<double>(options.most)) refuse(expected, options, edge);

    const CubeShares cubes = cubeShares(toolpath, selection, lattice, options.progress);
    const std::vector<std::uint32_t> chosen = chosenCubes(cubes);
    if (options.most > 0 && chosen.size() > options.most)
        refuse(std::max(expected, static_cast<double>(options.most)), options, edge);

    SolidElements elements;
    elements.edge = edge;
    std::copy_n(cubes.origin, 3, elements.origin);
    elements.plastic = cubes.plastic * edge * edge * edge;
    elements.list.reserve(chosen.size());
    for (const std::uint32_t n : chosen) {
        const CubeShare& cube = cubes.list[n];
        elements.list.push_back({cube.i, cube.j, cube.k, selection.front()});
    }
    setBeads(toolpath, selection, lattice, elements);
    return elements;
}

}  // namespace stratum::mechanics
