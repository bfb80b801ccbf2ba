// An Intersector that also knows what its grids say at a hit.
#pragma once

#include "march/attribute/attribute_grid.h"
#include "march/file/leaf_field.h"
#include "trace/intersector.h"

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
std::shared_ptr<const trace::Intersector> annotate(std::shared_ptr<const trace::Intersector> shape,
                                                   Annotation annotation);

}  // namespace stratum::march
