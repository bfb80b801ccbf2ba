// An Intersector with attribute grids and smooth normals.
#pragma once

#include "march/attribute/attribute_grid.h"
#include "march/file/leaf_field.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace stratum::march {

// Smooth normals: gradients without the discontinuities at the faces of cells.

/// Single samples of a level set, world units. Belongs to one thread.
class SampleReader {
public:
    virtual ~SampleReader() = default;
    virtual float at(const openvdb::Coord& place) = 0;
};

/// The gradient of the trilinear field is discontinuous at every face between cells, which is visible as facets on
/// glossy surfaces. Central differences over a voxel to each side are continuous, but blur sharp creases between two
/// beads. So both are blended by the curvature of the field within that voxel: below kSmooth (change of slope per
/// voxel: a radius of 3 voxels) central differences, above kCrease the gradient in the cell. Belongs to one thread.
/// Keeps a reference to the grid or field. World space.
class SmoothNormal {
public:
    static constexpr double kSmooth = 0.33;
    static constexpr double kCrease = 0.7;

    explicit SmoothNormal(const openvdb::FloatGrid& grid);
    explicit SmoothNormal(const LeafField& field);
    /// @param position   a point of the surface
    /// @param geometric  the unit normal there, in the cell
    /// Unit length, on the side of `geometric`; `geometric` itself where the gradient is zero.
    glm::dvec3 at(const glm::dvec3& position, const glm::dvec3& geometric);

private:
    SmoothNormal(const openvdb::math::Transform& transform, std::unique_ptr<SampleReader> samples);
    double field(const glm::dvec3& p);

    openvdb::math::MapBase::ConstPtr map_;
    std::unique_ptr<SampleReader> samples_;
    glm::dmat3 to_index_;  // of directions; its transpose takes gradients to world space
};

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
