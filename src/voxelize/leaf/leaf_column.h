// One leaf column: plan fields of its layers, expanded along z into leaves.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/plan_bins.h"
#include "voxelize/leaf/leaf_kernels.h"
#include "voxelize/leaf/plan_layers.h"
#include "voxelize/leaf/settling_kernels.h"
#include "voxelize/swell/swell_field.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace stratum::voxelize {

using Leaf = openvdb::FloatTree::LeafNodeType;

/// First and last leaf of a run along z, in leaves from index 0.
using LeafRange = std::pair<int, int>;

/// The leaves that the band around a solid between two heights (mm) reaches.
LeafRange leavesAround(const Lattice& lattice, double z_min, double z_max);

/// Of all beads; not of none.
LeafRange leavesAround(const Lattice& lattice, const LayerStack& stack);

/// Scratch of one thread: opens columns one after the other and evaluates their leaves from the bottom up. Plan fields
/// are kept in a window that moves up with the leaves, so memory is that of the layers that overlap one leaf.
class LeafColumn {
public:
    enum class Kind : std::uint8_t {
        values,                ///< of leaves, and the nearest bead of each voxel; see owners()
        kept,                  ///< the same of single leaves in any order: plan fields are kept for later ones
        spread,                ///< for measurements: plan fields at ColumnGrid::spread()
        spread_without_swell,  ///< the same without what LayerStack::swell adds
    };
    /// `scale` is in world units a mm. The references must outlive the object.
    LeafColumn(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, double scale,
               Kind kind = Kind::values);

    /// Opens the column whose first voxel is (i, j), reached by the beads of these ranks. Beads with an index in the
    /// toolpath of `end` or more are left out.
    void open(int i, int j, std::span<const std::uint32_t> ranks, std::uint32_t end);

    /// Whether that column is open for the beads below `end`, and this leaf not below one that was evaluated.
    bool mayEvaluate(int i, int j, std::uint32_t end, int leaf_k) const {
        return i == i_ && j == j_ && end == end_ && leaf_k > leaf_k_;
    }

    /// The leaves that the open column's beads from index `begin` on can touch: ascending and disjoint. Valid until the
    /// next call.
    std::span<const LeafRange> touched(std::uint32_t begin = 0);

    /// An upper bound on the leaves of a column, from z extents alone: ascending and disjoint. Does not open it; valid
    /// until the next call.
    std::span<const LeafRange> bounds(std::span<const std::uint32_t> ranks);

    /// Evaluates a leaf of the open column: its eight planes, or with `planes` = kMostPlanes also the plane above.
    /// `leaf_k` must ascend from call to call until the next open().
    LeafContent evaluate(int leaf_k, std::size_t planes = kLeafPlanes);

    /// A new leaf with the values of the last evaluate(), which must have returned LeafContent::surface.
    std::unique_ptr<Leaf> makeLeaf() const;
    /// The same values in leaf order and the mask of the active ones, without a leaf.
    void storeValues(std::span<float, Leaf::SIZE> values, std::span<std::uint64_t, 8> active) const;
    /// The values of evaluate(), clamped to the background, world units.
    const LeafPlanes& planes() const { return phi_; }

    /// For each voxel of the leaf just evaluated, in leaf order, the rank of the bead whose surface is nearest; of
    /// equally near beads the earlier one. Only where a bead is within the band.
    void owners(std::span<std::uint32_t, Leaf::SIZE> ranks);

    /// World units a mm.
    double scale() const { return scale_; }

    /// One layer over the open column, by plan: for measurements.
    struct LayerPlan {
        const Layer* layer = nullptr;
        std::span<const std::uint32_t> ranks;  ///< of the beads
        std::span<const BeadPlan> beads;       ///< in the same order
        const PlanField* sides2 = nullptr;     ///< squared plan distance beyond the flats, after filling grooves
        const PlanField* swollen = nullptr;    ///< the same after LayerStack::swell; null where it changes nothing
        const PlanField* rise = nullptr;       ///< by which the top is moved up; null where it is not
    };
    /// Calls visit() for each layer of the open column, from the lowest. Only of a column of which no leaf is
    /// evaluated.
    template <typename Visit>
    void forEachLayer(Visit visit) {
        for (const ColumnLayer& source : column_layers_) visit(planLayer(source));
    }
    /// Calls visit(bead) for each sloped or round bead of the open column: its index in the toolpath.
    template <typename Visit>
    void forEachDirect(Visit visit) const {
        for (const DirectBead& direct : direct_) visit(stack_.beads[direct.rank]);
    }
    bool hasDirect() const { return !direct_.empty(); }
    /// Of the plan fields' value c, mm.
    gcode::PlanPoint sample(std::size_t c) const {
        return {middle_x_ + static_cast<double>(grid_.qx.v[c]) / scale_,
                middle_y_ + static_cast<double>(grid_.qy.v[c]) / scale_};
    }
    /// Calls visit(layer, d) for each layer of the open column, from the lowest: its index in LayerStack::layers, and
    /// the plan distance beyond its flats as the level set has it, after settling. Only of a column of which no leaf is
    /// evaluated.
    template <typename Visit>
    void forEachField(Visit visit) {
        for (const ColumnLayer& source : column_layers_) visit(source.layer, fieldOf(source));
    }

    /// Calls visit(layer, sides2, nearest) for each layer of the open column for which wanted(layer) holds, from the
    /// lowest: its index in LayerStack::layers, the squared plan distance beyond its flats, and, only of layers with a
    /// crown, the plan distance to the flat of the nearest bead before grooves are filled. Only of a column of which no
    /// leaf is evaluated.
    template <typename Wanted, typename Visit>
    void forEachSides(Wanted wanted, Visit visit) {
        for (const ColumnLayer& source : column_layers_) {
            if (!wanted(source.layer)) continue;
            fieldOf(source);
            visit(source.layer, sides2_, nearest_);
        }
    }

private:
    struct ColumnLayer {
        std::uint32_t layer;
        std::uint32_t first, last;  // entries of ranks_
        bool loaded;
    };
    struct PlanWeld {
        double interface_low, interface_high;  // mm, the two planes that touch
        double middle_z, half;                 // mm
        PlanField d;                           // max of the two layers
    };
    struct DirectBead {
        double z_min, z_max;  // mm, with the band
        std::uint32_t rank;
    };

    double sampleZ(int k) const { return lattice_.origin_z + k * lattice_.voxel_size; }
    LeafRange leafRange(double z_min, double z_max) const { return leavesAround(lattice_, z_min, z_max); }
    void mergeRanges();
    void moveWindow(double z_min, double z_max);
    /// Fills lines_, tapers_ and arcs_, and the ranks of each.
    void gatherPaths(const ColumnLayer& source, bool with_ranks);
    /// The least plan distance to those paths.
    void minimumOfPaths(PlanField& d, PlanOwners* owners) const;
    void loadLayer(const ColumnLayer& source);
    void fillLayer(const ColumnLayer& source, PlanLayer& plan);
    void findOwners(PlanLayer& plan);
    LayerPlan planLayer(const ColumnLayer& source);
    const PlanField& fieldOf(const ColumnLayer& source);
    /// d over those paths, before the outlines of the layer move out, and squared; returns the least of the latter.
    /// Where the layer has a crown, nearest_ is d before grooves are filled.
    float fieldOfPaths(const Layer& layer, PlanField& d, PlanField& sides2);
    /// Moves those paths into near_, as beads; with a rule only those that may fill a groove by it.
    void planPaths(const GrooveRule* rule);
    std::span<const BeadPlan> nearBeads() const { return std::span(near_).first(near_count_); }
    /// Fills the grooves between the beads in near_; d is the minimum over all paths.
    float fillBetweenNear(const GrooveRule& rule, PlanField& d, PlanField& sides2);
    BeadPlan& nextNear() {
        if (near_count_ == near_.size()) near_.emplace_back();
        return near_[near_count_++];
    }
    /// Moves the outlines of a layer out by LayerStack::swell. True if anything changed; `least` is of sides2 then.
    bool swell(std::uint32_t layer, PlanField& d, PlanField& sides2, float& least);
    /// By how much the top of a layer is moved up, world units; `nearest`: as of forEachSides(). True if it is
    /// anywhere; `most`, mm, is as much or more.
    bool raise(std::uint32_t layer, const PlanField& nearest, PlanField& rise, double& most);
    void placeSwell();
    /// Sets swell_sources_. `z`: as of TilePlace.
    void findSwellTiles(std::uint32_t z);
    /// Asks for what swell() and raise() of a layer need.
    void prefetchSwell(std::uint32_t layer);
    /// One kind of values of a layer at the nodes of the open column, into swell_nodes_. False if the layer has none.
    bool gatherNodes(std::uint32_t layer, NodeValues SwellTile::*kind);
    /// Those values at the samples, times `scale`. False if all are 0.
    bool valuesOf(std::uint32_t layer, NodeValues SwellTile::*kind, double scale, PlanField& values);
    void addWelds(const PlanLayer& upper);
    void gatherTerms(int k0);
    /// Into the planes from k0, the first of a leaf.
    void expandDirect(const DirectBead& direct, int k0, std::span<PlanField> planes);

    const gcode::Toolpath& toolpath_;
    const LayerStack& stack_;
    const Lattice& lattice_;
    const double scale_, band_;  // world units a mm; mm
    const bool with_swell_;
    const ColumnGrid grid_;
    const double half_extent_;               // mm: the samples' coordinates from the middle of the column
    double thickest_ = 0;                    // mm, the largest half height of a layer
    std::vector<std::size_t> weld_offsets_;  // CSR over stack_.welds by upper layer

    // The open column.
    int i_ = 0, j_ = 0;
    int leaf_k_ = std::numeric_limits<int>::max();  // evaluated last; the largest before a column is open
    double middle_x_ = 0, middle_y_ = 0;            // mm
    std::span<const std::uint32_t> ranks_;
    std::uint32_t end_ = 0;
    std::vector<ColumnLayer> column_layers_;
    std::size_t next_layer_ = 0;
    std::vector<DirectBead> direct_;  // ascending z_min
    std::size_t first_direct_ = 0;
    std::vector<LeafRange> ranges_;

    // The window: window_ lists the slots in use, by_layer_ finds them by (layer, slot), ascending.
    PlanLayers slots_;
    std::vector<std::uint32_t> window_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_layer_;
    std::vector<std::pair<double, std::size_t>> partners_;  // of a layer to weld: gap, place in by_layer_
    std::vector<PlanWeld> welds_;
    std::vector<double> half_heights_;  // distinct, of the window
    std::vector<LocalLine> lines_;
    std::vector<LocalTaper> tapers_;
    std::vector<LocalArc> arcs_;
    std::vector<std::uint32_t> line_ids_, taper_ids_, arc_ids_;
    std::vector<BeadPlan> near_;          // beads that may fill a groove; all of the layer in planLayer()
    std::size_t near_count_ = 0;          // of near_, those in use
    std::vector<std::uint32_t> filling_;  // of near_, those that do
    PlanField d_, sides2_;                // of planLayer()
    PlanField swollen_, rise_;            // likewise
    PlanField between_;                   // scratch
    PlanField nearest_;                   // of forEachSides()
    // Where the swell of the open column comes from.
    struct SwellSource {
        const SwellTile* tile;
        int first_i, last_i, first_j, last_j;  // nodes of the column that the tile owns
    };
    bool swell_placed_ = false;
    int first_node_i_ = 0, first_node_j_ = 0, nodes_i_ = 0, nodes_j_ = 0;
    std::optional<std::uint32_t> swell_tiles_z_;  // of swell_sources_
    std::vector<SwellSource> swell_sources_;
    std::vector<float> swell_nodes_;
    float largest_node_ = 0;                    // of valuesOf(), before it is scaled
    std::vector<PlanField> ramps_x_, ramps_y_;  // of nodeRamps()
    LeafTerms terms_;
    LeafPlanes phi_{};
};

}  // namespace stratum::voxelize
