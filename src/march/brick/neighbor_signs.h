// Which neighbours a brick of a field can do without.
#pragma once

#include "march/brick/brick_layout.h"
#include "march/file/leaf_field.h"

#include <limits>

namespace stratum::march {

/// A brick takes the first samples of the leaves at +x, +y and both. Where its own last samples are farther from zero
/// than LeafField::signSlack() and a voxel, no cell between them has surface, and only the sign of those of the
/// neighbour counts: a leaf less to compute.
class NeighborSigns {
public:
    /// Of sources that are no fields: nothing is assumed.
    NeighborSigns() = default;
    /// `quantum`: world units a unit of the samples.
    NeighborSigns(const LeafField& field, double quantum);

    /// `parts` has the brick's own leaf, and tiles of the background, which is above zero. Sets the tiles and
    /// BrickParts::assumed of neighbours whose samples all have one known sign and belong to no surface cell.
    template <typename T>
    void assume(BrickParts<T>& parts) const;

private:
    /// In units of the samples: distances from zero beyond which samples beside one, and diagonally beside it, have its
    /// sign.
    double beside_ = std::numeric_limits<double>::infinity();
    double diagonally_ = std::numeric_limits<double>::infinity();
};

}  // namespace stratum::march
