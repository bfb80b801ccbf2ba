// LayerStack -> FloatGrid: the level set of the part as printed.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/estimate.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/placement.h"
#include "voxelize/grid/attributes.h"
#include "voxelize/grid/deposit_balance.h"
#include "voxelize/grid/leaf_stream.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace stratum::voxelize {

/// Treatment of surfaces that are not reachable from outside.
enum class Interior : std::uint8_t {
    keep,  ///< all are kept: infill, gaps between beads
    cull,  ///< they are filled, and their leaves are not built. The remaining surface has the same bits; gaps
    ///< narrower than a voxel, or than 0.3 layer heights, are filled below a depth of three voxels; see
    ///< exterior.h
};

struct VoxelizeOptions {
    Placement placement;
    Interior interior = Interior::keep;
    /// Of memory for each leaf, of the grid and of what will be made beside it; stream() alone holds none: 0.
    double bytes_per_leaf = kBytesPerLeaf;
    /// Refuse before building if the estimate is larger, bytes. 0: 90 % of what the machine has available.
    std::size_t memory_limit = 0;
    /// Called from time to time with the fraction done, 0..1, from any of the working threads, one call at a time.
    std::function<void(double)> progress;
};

/// Statistics of the last build, for reports.
struct VoxelizeReport {
    std::size_t leaf_positions = 0;  ///< that beads touch
    std::size_t leaves_evaluated = 0;
    std::size_t leaves_reused = 0;  ///< unchanged since the partial print before
    int flood_rounds = 0;
    double bin_seconds = 0;       ///< wall
    double exterior_seconds = 0;  ///< of the wall time, the share of finding the exterior; distances not counted
    double build_seconds = 0;     ///< wall, the exterior included
};

/// What Interior::cull would keep of a grid.
struct CullForecast {
    std::size_t leaves = 0;
    std::size_t active_voxels = 0;
};

/// Voxelizes a print, whole or as a series of growing partial prints on one lattice. Layers and bins are made once;
/// each step evaluates the leaves that new beads touch.
///
/// Values outside the solid are signed distances to the union, exact to float rounding; inside they are negative
/// everywhere (layers are welded) but a bound, not a distance. Active voxels are those within the half-width; with
/// Interior::cull those inside only within the half-width less one (at most 8 voxels) of a sample seen from outside.
/// Inactive voxels and tiles have plus or minus the background. Every voxel's sign is set: a signed flood fill changes
/// nothing. Parallel with TBB; the result does not depend on the number of threads, nor on the steps before it.
class Voxelizer {
public:
    /// `selection`: indices into toolpath.beads, ascending. `toolpath` and `lattice` must outlive the object. Throws
    /// UsageError with the estimate if the grid would not fit.
    Voxelizer(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
              VoxelizeOptions options = {});
    ~Voxelizer();
    Voxelizer(const Voxelizer&) = delete;
    Voxelizer& operator=(const Voxelizer&) = delete;

    /// Advances the grid to the selected beads before index `end` of the toolpath; `end` must not decrease. The grid
    /// belongs to this object and changes with the next step.
    openvdb::FloatGrid::Ptr printUntil(std::uint32_t end);
    openvdb::FloatGrid::Ptr printAll() { return printUntil(0xffffffff); }

    /// The leaves of the selected beads before index `end` of the toolpath, one after the other instead of as a grid;
    /// only with Interior::keep. The values and masks are those of printUntil() of a new Voxelizer. `bounds`:
    /// leafBounds().
    LeafStreamReport stream(std::uint32_t end, const LeafBounds& bounds, LeafReceiver& receiver, bool measure);
    LeafBounds leafBounds() const;
    /// Name, class, transform and background of the grid, without a voxel.
    openvdb::FloatGrid::Ptr emptyGrid() const;

    /// Attribute grids over the active voxels of the current grid, in the given order. Progress restarts at 0. Throws
    /// UsageError if memory is short.
    std::vector<openvdb::GridBase::Ptr> attributes(std::span<const Attribute> wanted) const;

    /// Counts what Interior::cull would keep of the current grid, which Interior::keep built. Reads existing leaves
    /// instead of evaluating distances; takes about a third of the time of a build.
    CullForecast forecastCull() const;

    /// How much of the beads printed or streamed so far, or of all if none was, their layers have room for:
    /// balanceDeposit().
    DepositBalance balance() const;

    const VoxelizeReport& report() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The whole selection at once.
openvdb::FloatGrid::Ptr voxelize(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                 const Lattice& lattice, const VoxelizeOptions& options = {});

}  // namespace stratum::voxelize
