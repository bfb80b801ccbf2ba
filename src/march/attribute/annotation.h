// An Intersector with attribute grids and smooth normals.
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
    std::vector<std::shared_ptr<const AttributeSource>> attributes;  ///< by number; null for missing ones
    std::shared_ptr<const LeafField> smooth_field = nullptr;         ///< instead of `smooth`

    std::shared_ptr<const AttributeSource> grain = nullptr;  ///< of Tracer::grain(), as a vector; null: none

    bool empty() const;
};

/// `shape` traces the rays; the grids, which are kept, give Tracer::shadingNormal(), grain() and attribute(). Returns
/// `shape` itself if there is nothing to add.
std::shared_ptr<const trace::Intersector> annotate(std::shared_ptr<const trace::Intersector> shape,
                                                   Annotation annotation);

}  // namespace stratum::march
