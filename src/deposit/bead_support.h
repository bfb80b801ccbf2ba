// Which parts of a level bead have plastic or the bed below them.
#pragma once

#include "deposit/bead_path.h"
#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <vector>

namespace stratum::deposit {

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

/// Finds the supports of the beads of a toolpath, which must stay as it is meanwhile.
class BeadSupport {
public:
    explicit BeadSupport(const gcode::Toolpath& toolpath);

    /// Whether it is level and has usable coordinates and sizes. Others carry nothing and are not looked up.
    bool level(std::uint32_t bead) const { return level_[bead]; }

    /// `parts`: the supported parts of a level bead, ascending and apart, in mm of its path. Layer 0 (prime lines), the
    /// lowest layer, beads on the bed, and ironing, which runs in a finished surface, are supported everywhere.
    void find(std::uint32_t bead, std::vector<PathPart>& parts);

    /// The rule in z alone: whether `lower` can carry `upper` where their paths are near enough.
    bool below(const gcode::Bead& lower, const gcode::Bead& upper) const;

    /// Plan distance up to which `lower` carries `upper`, mm.
    static double reach(const gcode::Bead& lower, const gcode::Bead& upper);

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

    const gcode::Toolpath& toolpath_;
    std::uint32_t lowest_layer_ = 0;
    std::vector<bool> level_;
    // Each cell of the plan lists the level beads over it by their tops: entries_[starts_[cell]..starts_[cell + 1]).
    double cell_ = 2;                     // mm
    double origin_x_ = 0, origin_y_ = 0;  // mm
    long columns_ = 0, rows_ = 0;
    std::vector<std::size_t> starts_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> asked_;  // by lower bead: the last one that it was looked at for, plus 1
};

}  // namespace stratum::deposit
