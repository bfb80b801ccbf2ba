// Which samples of a level set the outside reaches: the hull of the part, and its open and closed pores.
//
// Printed parts are not airtight: beads laid side by side leave channels, which reach the outside somewhere. So there
// are two floods from around the part. The first takes samples whose distance from the plastic is at least a clearance,
// hullClearance(). What it reaches, and what a ball of that radius touches from there (three voxels at least), is
// outside. The second takes every sample that is not plastic. A pore is what the first does not reach: open if the
// second does, else closed.
#pragma once

#include "report/level_set/leaf_map.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/leaf/leaf_mask.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::report {

enum class Air : std::uint8_t { outside, open, closed };

/// mm. Holes at the turns of lines are narrower than the height of a layer; the hull passes over them at every voxel
/// size.
inline double hullClearance(const voxelize::Lattice& lattice) {
    return std::max(0.5 * lattice.voxel_size, 0.5 * lattice.layer_height);
}

class Outside {
public:
    /// `clearance` and `voxel` in the grid's world units; the first is hullClearance() of a print, and at most half a
    /// voxel less than the `background` is used, for no sample has a larger distance. Parallel; the same result for any
    /// number of threads.
    Outside(const LeafMap& map, double clearance, double voxel, double background);

    /// Of a sample that is not plastic.
    Air at(std::size_t leaf, int x, int y, int z) const {
        const std::uint64_t bit = std::uint64_t{1} << (y * 8 + z);
        const auto word = static_cast<std::size_t>(x);
        return (shown_[leaf].word[word] & bit) != 0 ? Air::outside
               : (any_[leaf].word[word] & bit) != 0 ? Air::open
                                                    : Air::closed;
    }
    /// Of a gap that is not solid.
    Air ofGap(std::size_t gap) const {
        return gap == LeafMap::kNowhere || gap_wide_[gap] != 0 ? Air::outside
               : gap_any_[gap] != 0                            ? Air::open
                                                               : Air::closed;
    }
    const voxelize::LeafMask& shown(std::size_t leaf) const { return shown_[leaf]; }
    const voxelize::LeafMask& any(std::size_t leaf) const { return any_[leaf]; }

private:
    void findShown(const LeafMap& map, float clearance, int depth);

    std::vector<voxelize::LeafMask> shown_, any_;
    std::vector<std::uint8_t> gap_wide_, gap_any_;
};

}  // namespace stratum::report
