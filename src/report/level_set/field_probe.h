// The level set at any point of print space.
#pragma once

#include "report/level_set/outside.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <cmath>

namespace stratum::report {

struct Point {
    double x = 0, y = 0, z = 0;  ///< mm, print space
};

/// The trilinear field at a point; `sample(i, j, k)` is its value there on the lattice.
template <typename Sample>
double trilinear(const voxelize::Lattice& lattice, const Point& p, const Sample& sample) {
    const double at[3] = {p.x / lattice.voxel_size, p.y / lattice.voxel_size,
                          (p.z - lattice.origin_z) / lattice.voxel_size};
    const double low[3] = {std::floor(at[0]), std::floor(at[1]), std::floor(at[2])};
    const int cell[3] = {static_cast<int>(low[0]), static_cast<int>(low[1]), static_cast<int>(low[2])};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int step[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double t = at[axis] - low[axis];
            weight *= step[axis] != 0 ? t : 1 - t;
        }
        sum += weight * static_cast<double>(sample(cell[0] + step[0], cell[1] + step[1], cell[2] + step[2]));
    }
    return sum;
}

/// One thread's. All it refers to must outlive it.
class FieldProbe {
public:
    FieldProbe(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, const LeafMap& map,
               const Outside* outside)
        : tree_(grid.tree()), lattice_(lattice), map_(map), outside_(outside) {}

    /// Of the trilinear field; negative inside. Its unit is the grid's.
    double value(const Point& p) const {
        return trilinear(lattice_, p, [this](int i, int j, int k) { return tree_.getValue(openvdb::Coord(i, j, k)); });
    }

    /// Whether the nearest sample is air that belongs to the outside; of a culled grid, whether it is air.
    bool isOutside(const Point& p) const {
        const openvdb::Coord at(static_cast<int>(std::lround(p.x / lattice_.voxel_size)),
                                static_cast<int>(std::lround(p.y / lattice_.voxel_size)),
                                static_cast<int>(std::lround((p.z - lattice_.origin_z) / lattice_.voxel_size)));
        if (tree_.getValue(at) < 0) return false;
        if (outside_ == nullptr) return true;
        const LeafMap::Place place = map_.positions().at(at.x() >> 3, at.y() >> 3, at.z() >> 3);
        if (!place.leaf) return outside_->ofGap(place.index) == Air::outside;
        return outside_->at(place.index, at.x() & 7, at.y() & 7, at.z() & 7) == Air::outside;
    }

private:
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> tree_;
    const voxelize::Lattice& lattice_;
    const LeafMap& map_;
    const Outside* outside_;
};

}  // namespace stratum::report
