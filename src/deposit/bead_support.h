// Which parts of a level bead have plastic or the bed below them, or lie beside a bead that has.
#pragma once

#include "gcode/toolpath/plan_path.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::deposit {

// Which parts of a bead's path in the plan are near another path.

/// A part of a path, mm from its start.
struct PathPart {
    double from = 0;
    double to = 0;
};

constexpr double kFineStep = 0.05;  ///< mm

/// Appends the parts of `path` that are within `reach` (mm) of `other`. Two segments: one part at most, in closed form.
/// With an arc: the ends are bisected to a micrometre, and parts shorter than kFineStep may be missed. Returns how many
/// distances that took; closed forms count as one.
std::size_t partsNear(const gcode::PlanPath& path, const gcode::PlanPath& other, double reach,
                      std::vector<PathPart>& parts);

/// The same for the places that are beside `other`: within `reach` of their nearest place on it, which is in its part
/// `held`, and seen from which they lie more across `path` than along it (so not ahead of an end, nor where the two
/// cross steeply). Parts may overlap. A path of no length has no direction: for it, reach and part decide.
std::size_t partsBeside(const gcode::PlanPath& path, const gcode::PlanPath& other, PathPart held, double reach,
                        std::vector<PathPart>& parts);

/// A lower bead carries an upper one where the plan distance of their paths is at most this fraction of their mean
/// width: a quarter of that width then lies on the other. At 1/2, half of the upper bead is beyond the side of the
/// lower one, as in any overhanging wall. Neighbours of one layer are 1 - 0.215 height / width of it apart, about 0.9:
/// a bead so far from the wall below lies beside it, not on it.
constexpr double kContact = 0.75;

/// A top and an underside this close touch: a fraction of the upper bead's height, and mm for rounded coordinates.
constexpr double kTouchingShare = 0.02;
constexpr double kTouchingRounding = 0.001;

/// What carries a bead ends at least this fraction of its height below its top. Thick bridges (height = diameter) reach
/// below the top of the layer that they lie on; beads of their own layer end where they do, and carry nothing.
constexpr double kLeastBurial = 0.1;

/// mm between a print and its support material. Slicers leave 0.1 to 0.2 so that the two part; a bead comes to rest on
/// it after that, so it does not hang.
constexpr double kSupportClearance = 0.3;

/// Beads with one top touch where the plan distance of their paths is at most this fraction of their mean width.
/// Slicers put neighbours 1 - 0.215 height / width of it apart, but leave 0.05 mm between the round lines of bridges
/// and overhanging perimeters: measured 1.0 to 1.1, 1.125 between those of a 0.4 mm nozzle. The line after the next is
/// at 1.7 and more.
constexpr double kBeside = 1.15;

/// Bounds of the search, for hostile files; past one of them a bead counts as supported everywhere, so that it does not
/// sag. In a cell of the plan (2 mm, or 1/1024 of the print if that is more), level beads with tops that are in
/// question. At most 510 in the test prints:
constexpr std::size_t kMostInCell = 2048;
/// Distances to other beads that are computed for one bead, for what is below it, and again for what is beside it. At
/// most 774 in the test prints, 3625 in those with arcs, which are walked along:
constexpr std::size_t kMostDistances = 6000;

/// Finds the supports of the beads of a toolpath, which must stay as it is meanwhile. Once made, it is used by any
/// number of threads, each with a Search of its own.
class BeadSupport {
public:
    /// What one thread uses for its searches.
    struct Search {
        std::vector<std::uint32_t> asked;  // by bead: the last search that met it
        std::uint32_t searches = 0;
        std::vector<std::uint32_t> candidates;
        std::vector<PathPart> neighbour_parts;
    };

    /// Searches below all level beads, on all threads.
    explicit BeadSupport(const gcode::Toolpath& toolpath);

    /// Whether it is level and has usable coordinates and sizes. Others carry nothing and are not looked up.
    bool level(std::uint32_t bead) const { return level_[bead]; }

    /// `parts`: the supported parts of a level bead, ascending and apart, in mm of its path: those of fromBelow(), and
    /// those beside (partsBeside) a bead that has support from below there, for the outer line of an
    /// overhanging wall is glued to the inner one. This goes one bead far, so that bridges hang: their lines next to a
    /// supported perimeter are held along it, but hold no others. Print order and features make no difference.
    void find(std::uint32_t bead, std::vector<PathPart>& parts, Search& search) const;

    /// The same, from below alone. Layer 0 (prime lines), the lowest layer, beads on the bed, and ironing, which runs
    /// in a finished surface, are supported everywhere.
    void fromBelow(std::uint32_t bead, std::vector<PathPart>& parts) const;

    /// The rule in z alone: whether `lower` can carry `upper` where their paths are near enough.
    bool below(const gcode::Bead& lower, const gcode::Bead& upper) const;
    /// The rule in z alone: whether `neighbour` can hold `bead` where it is beside it. Their tops are one, up to
    /// rounding; undersides may differ, for thick bridges reach below the perimeters beside them. Ironing holds
    /// nothing.
    bool holds(const gcode::Bead& neighbour, const gcode::Bead& bead) const;

    /// Plan distance up to which `lower` carries `upper`, mm.
    static double reach(const gcode::Bead& lower, const gcode::Bead& upper);
    /// Plan distance up to which beads with one top touch, mm.
    static double reachBeside(const gcode::Bead& a, const gcode::Bead& b);

private:
    struct Entry {
        float top;  // mm
        std::uint32_t bead;
    };

    bool usable(const gcode::Bead& bead) const;
    bool everywhere(const gcode::Bead& bead) const;
    void setGrid();
    void fillGrid();
    template <typename Visit>
    void visitCells(const gcode::Bead& bead, const Visit& visit) const;
    template <typename Accept>
    bool gather(std::uint32_t bead, double lowest, double highest, const Accept& accept, Search& search) const;
    template <typename Append>
    static void unite(const gcode::PlanPath& path, const std::vector<std::uint32_t>& candidates,
                      std::vector<PathPart>& parts, const Append& append);
    void searchBelow(std::uint32_t bead, std::vector<PathPart>& parts, Search& search) const;
    void searchBelowAll();

    const gcode::Toolpath& toolpath_;
    std::uint32_t lowest_layer_ = 0;
    std::vector<bool> level_;
    // Each cell of the plan lists the level beads over it by their tops: entries_[starts_[cell]..starts_[cell + 1]).
    double cell_ = 2;                     // mm
    double origin_x_ = 0, origin_y_ = 0;  // mm
    long columns_ = 0, rows_ = 0;
    std::vector<std::size_t> starts_;
    std::vector<Entry> entries_;
    // What is below, by bead: kNone, kWhole, or the first of its parts in below_parts_[bead / kSearchBlock], up to one
    // with from > to.
    std::vector<std::uint32_t> below_;
    std::vector<std::vector<PathPart>> below_parts_;
};

}  // namespace stratum::deposit
