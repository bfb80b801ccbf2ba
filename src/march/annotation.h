// An Intersector that also knows what its grids say at a hit.
#pragma once

#include "march/attribute_grid.h"
#include "march/intersector.h"
#include "march/leaf_field.h"

#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

namespace stratum::march {

struct Annotation {
    openvdb::FloatGrid::ConstPtr smooth;  ///< the level set, for smooth normals; null: geometric ones
    std::vector<std::shared_ptr<const AttributeSource>> attributes;  ///< by number; null where there is no such one
    std::shared_ptr<const LeafField> smooth_field = nullptr;         ///< instead of `smooth`

    bool empty() const;
};

/// Rays are answered by `shape` as before; Tracer::shadingNormal() and attribute() by the grids, which are kept. With
/// nothing to add, `shape` itself.
std::shared_ptr<const Intersector> annotate(std::shared_ptr<const Intersector> shape, Annotation annotation);

}  // namespace stratum::march
