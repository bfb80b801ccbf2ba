// LayerStack -> FloatGrid: the level set of the part as printed.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/placement.h"
#include "voxelize/grid/attributes.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// What becomes of surfaces that no outside point can reach.
enum class Interior : std::uint8_t {
    keep,  ///< all are there: infill, gaps between beads
    cull,  ///< they are filled, and their leaves never built. What stays has the same bits; gaps narrower than a
           ///< voxel, or 0.3 layer heights, are filled from three voxels below where the outside comes to; see
           ///< exterior.h
};

struct VoxelizeOptions {
    Placement placement;
    Interior interior = Interior::keep;
    /// Refuse before building if the estimate is larger, bytes. 0: 90 % of what the machine has available.
    std::size_t memory_limit = 0;
    /// Called now and then with the fraction done, 0..1, from any of the working threads, one call at a time.
    std::function<void(double)> progress;
};

/// What the last build did, for reports.
struct VoxelizeReport {
    std::size_t leaf_positions = 0;  ///< that beads touch
    std::size_t leaves_evaluated = 0;
    std::size_t leaves_reused = 0;  ///< unchanged since the partial print before
    int flood_rounds = 0;
    double bin_seconds = 0;       ///< wall
    double exterior_seconds = 0;  ///< of the wall time, the share of finding the exterior; distances not counted
    double build_seconds = 0;     ///< wall, the exterior included
};

/// What Interior::cull would leave of a grid.
struct CullForecast {
    std::size_t leaves = 0;
    std::size_t active_voxels = 0;
};

/// Voxelizes a print, whole or as a series of ever more of it on one lattice. Layers and bins are made once; each step
/// evaluates the leaves that new beads touch.
///
/// Values outside the solid are signed distances to the union, exact to float rounding; inside they are negative
/// everywhere (layers are welded) but a bound, not a distance. Active voxels are those within the half-width; with
/// Interior::cull those inside only within the half-width less one (at most 8 voxels) of a sample seen from outside.
/// Inactive voxels and tiles hold plus or minus the background. Every voxel's sign is set: a signed flood fill changes
/// nothing. Parallel through TBB; the result does not depend on the number of threads, nor on the steps before it.
class Voxelizer {
public:
    /// `selection`: indices into toolpath.beads, ascending. `toolpath` and `lattice` must outlive the object. Throws
    /// UsageError with the estimate if the grid would not fit.
    Voxelizer(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
              VoxelizeOptions options = {});
    ~Voxelizer();
    Voxelizer(const Voxelizer&) = delete;
    Voxelizer& operator=(const Voxelizer&) = delete;

    /// Brings the grid to what is printed by the selected beads before index `end` of the toolpath; steps may only
    /// grow. The grid stays this object's and changes with the next step.
    openvdb::FloatGrid::Ptr printUntil(std::uint32_t end);
    openvdb::FloatGrid::Ptr printAll() { return printUntil(0xffffffff); }

    /// Attribute grids over the active voxels of the grid as it is now, in the given order. Progress runs anew.
    std::vector<openvdb::GridBase::Ptr> attributes(std::span<const Attribute> wanted) const;

    /// What Interior::cull would keep of the grid as it is now, which Interior::keep built. Looks the leaves up and
    /// evaluates nothing, yet costs about a third of a build.
    CullForecast forecastCull() const;

    const VoxelizeReport& report() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The whole selection at once.
openvdb::FloatGrid::Ptr voxelize(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                 const Lattice& lattice, const VoxelizeOptions& options = {});

}  // namespace stratum::voxelize
