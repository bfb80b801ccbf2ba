// A box of samples of a print, in one dense array.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace stratum::python {

/// The samples whose places (mm) lie in a box, and the box of the samples that the beads' band reaches. Print space.
openvdb::CoordBBox samplesIn(const voxelize::Bounds& box, const voxelize::Lattice& lattice);
openvdb::CoordBBox samplesAround(const voxelize::Bounds& solid, const voxelize::Lattice& lattice);

/// Throws UsageError, with the size and the remedy, if so many floats don't fit into memory, or if there are none.
void requireFits(const openvdb::CoordBBox& box);

/// Writes the samples of `box`, x slowest, z fastest, mm: those of the grid of voxelize::voxelize() with
/// Interior::keep, and its background where it has no leaves. Makes no grid: each value is written once, and only the
/// leaves that the box meets are made. Parallel.
void fillDense(const std::shared_ptr<const gcode::Toolpath>& toolpath, std::span<const std::uint32_t> selection,
               const voxelize::Lattice& lattice, const openvdb::CoordBBox& box, float* values,
               const std::function<void(double)>& progress);

}  // namespace stratum::python
