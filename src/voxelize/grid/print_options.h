// Options for reading G-code, selecting its beads, and choosing the voxel size.
#pragma once

#include "gcode/reader.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/placement.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::voxelize {

/// Lists stay text until there is a toolpath: selectionOf() parses them against it. The default is the whole print on
/// chooseLattice()'s default lattice.
struct PrintOptions {
    gcode::ReadOptions read;
    std::string printer;  ///< the preset or file that `read` has its printer from; empty: none was named
    LatticeRequest lattice;
    std::optional<double> tolerance;   ///< mm: the coarsest voxel whose surface stays this near to the beads
    std::string memory_budget;         ///< the finest voxel that fits, "4GB"; see parseSize(). Empty: none given
    bool voxel_auto = false;           ///< the voxel size follows from the size of a pixel, see latticeFor()
    std::string layers;                ///< see parseLayers(); empty: all
    std::string features;              ///< see parseFeatures(); empty: all
    std::vector<std::string> objects;  ///< names or numbers, see chooseObject(); empty: all
    std::vector<std::uint8_t> tools;   ///< T numbers; empty: all
};

/// Whether something says how large voxels are, but for voxel_auto.
bool choosesVoxels(const PrintOptions& options);

/// The beads of a print that the lists of layers, features and objects select. Throws UsageError or InputError.
Selection selectionOf(const PrintOptions& options, const gcode::Toolpath& toolpath);

/// The selection in words, "layers 1:20; features -skirt"; empty if all is kept.
std::string describeSelection(const PrintOptions& options);

/// The lattice: tolerance and memory_budget determine the voxels a layer, and with voxel_auto so does `pixel`, the
/// smallest size of a pixel on the print (mm; 0: not known); otherwise chooseLattice() decides, which is told it and
/// `bytes_per_leaf` (VoxelizeOptions). For requests of fewer than two voxels a layer, its warning has the share of the
/// beads that is lost. Throws UsageError.
Lattice latticeFor(const PrintOptions& options, const gcode::Toolpath& toolpath,
                   const std::vector<std::uint32_t>& selection, const Bounds& bounds, Interior interior,
                   double pixel = 0, double bytes_per_leaf = kBytesPerLeaf);

}  // namespace stratum::voxelize
