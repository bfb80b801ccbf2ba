#include "march/reference/reference_intersectors.h"

#include "march/file/grid_axes.h"
#include "march/file/level_set_file.h"

#include <openvdb/tools/RayIntersector.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace stratum::march {
namespace {

using Reference = openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>;

glm::dvec3 toGlm(const openvdb::Vec3d& v) { return {v[0], v[1], v[2]}; }
openvdb::Vec3d toVdb(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Gradient of the trilinear interpolant at an index-space point.
openvdb::Vec3d cellGradient(openvdb::FloatGrid::ConstAccessor& accessor, const openvdb::Vec3d& point) {
    const openvdb::Coord cell = openvdb::Coord::floor(point);
    const openvdb::Vec3d u = point - cell.asVec3d();
    double corner[2][2][2];
    for (int x = 0; x < 2; ++x)
        for (int y = 0; y < 2; ++y)
            for (int z = 0; z < 2; ++z)
                corner[x][y][z] = static_cast<double>(accessor.getValue(cell.offsetBy(x, y, z)));
    openvdb::Vec3d gradient(0, 0, 0);
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) {
            const double wx = a != 0 ? u[0] : 1 - u[0];
            const double wy_a = a != 0 ? u[1] : 1 - u[1];
            const double wy_b = b != 0 ? u[1] : 1 - u[1];
            const double wz = b != 0 ? u[2] : 1 - u[2];
            gradient[0] += wy_a * wz * (corner[1][a][b] - corner[0][a][b]);
            gradient[1] += wx * wz * (corner[a][1][b] - corner[a][0][b]);
            gradient[2] += wx * wy_b * (corner[a][b][1] - corner[a][b][0]);
        }
    return gradient;
}

// Everything below is in index space with a map copied once: the grid's own conversions copy a shared pointer for each
// ray, and its atomic count would be contended by all threads.
class VdbTracer final : public trace::Tracer {
public:
    VdbTracer(const openvdb::FloatGrid& grid, const openvdb::math::MapBase& map, const Reference& reference,
              const trace::Box& bounds)
        : map_(map),
          reference_(reference),
          accessor_(grid.getConstAccessor()),
          center_(0.5 * (bounds.min + bounds.max)),
          diagonal_(glm::length(bounds.max - bounds.min)) {}

    bool intersect(const trace::Ray& ray, trace::Hit& hit) override {
        openvdb::Vec3d index;
        if (!nearest(ray, index)) return false;
        hit.position = toGlm(map_.applyMap(index));
        hit.t = glm::dot(hit.position - ray.origin, ray.direction);
        // Gradients transform by the inverse transpose.
        openvdb::Vec3d normal = map_.applyIJT(cellGradient(accessor_, index));
        // A cell with a vanishing gradient has no normal; facing the ray keeps everything downstream finite.
        if (!normal.normalize(1e-30)) normal = -toVdb(ray.direction);
        hit.normal = toGlm(normal);
        return true;
    }

    bool occluded(const trace::Ray& ray) override {
        openvdb::Vec3d index;
        return nearest(ray, index);
    }

private:
    // The overload that returns only a time returns that of the *previous* ray in OpenVDB 10.0.1 (it is read before
    // the ray is traced; fixed in 13). The position is correct, and t is computed from it.
    bool nearest(const trace::Ray& ray, openvdb::Vec3d& index) {
        // OpenVDB scales times to index space: infinite ones are avoided.
        const double t_max = std::min(ray.t_max, glm::length(ray.origin - center_) + diagonal_);
        // OpenVDB requires a start above zero.
        const double t_min = std::max(ray.t_min, openvdb::math::Delta<double>::value());
        if (!(t_max > t_min)) return false;
        const Reference::RayType world(toVdb(ray.origin), toVdb(ray.direction), t_min, t_max);
        return reference_.intersectsIS(world.applyInverseMap(map_), index);
    }

    const openvdb::math::MapBase& map_;
    Reference reference_;  // a copy for each tracer: it has an accessor and the current ray
    openvdb::FloatGrid::ConstAccessor accessor_;
    const glm::dvec3 center_;  // of the bounds, world units
    const double diagonal_;
};

// OpenVDB's intersector requires cubes, and rejects small rotated voxels (its test compares a determinant with 1e-8).
// It marches in index space, so it gets the same tree on axis-aligned cubes; rays are mapped by the grid's own map. It
// uses the edge only for the width of the band in which it searches.
openvdb::FloatGrid::ConstPtr onCubes(const openvdb::FloatGrid& grid) {
    auto cubes = openvdb::FloatGrid::create(std::const_pointer_cast<openvdb::FloatTree>(grid.constTreePtr()));
    cubes->setGridClass(openvdb::GRID_LEVEL_SET);
    cubes->setTransform(openvdb::math::Transform::createLinearTransform(GridAxes(grid.transform()).longest()));
    return cubes;
}

class VdbIntersector final : public trace::Intersector {
public:
    explicit VdbIntersector(openvdb::FloatGrid::ConstPtr grid)
        : grid_(std::move(grid)),
          map_(grid_->transform().baseMap()),
          cubes_(onCubes(*grid_)),
          reference_(*cubes_),
          bounds_(narrowBandBounds(*grid_)) {}

    std::unique_ptr<trace::Tracer> makeTracer() const override {
        return std::make_unique<VdbTracer>(*grid_, *map_, reference_, bounds_);
    }
    std::string_view name() const override { return "vdb"; }
    trace::Box bounds() const override { return bounds_; }
    std::size_t bytes() const override { return 0; }
    double voxelSize() const override { return GridAxes(grid_->transform()).shortest(); }
    // The reference interpolates its root linearly between a voxel's faces, so a hit may be some hundredths of a voxel
    // inside the solid; a secondary ray from there would hit the surface from inside.
    double surfaceOffset() const override { return 0.1 * voxelSize(); }

private:
    openvdb::FloatGrid::ConstPtr grid_;
    openvdb::math::MapBase::ConstPtr map_;
    openvdb::FloatGrid::ConstPtr cubes_;
    Reference reference_;
    trace::Box bounds_;
};

}  // namespace

std::unique_ptr<trace::Intersector> makeVdbIntersector(openvdb::FloatGrid::ConstPtr grid) {
    requireTraceable(*grid, grid->getName());
    return std::make_unique<VdbIntersector>(std::move(grid));
}

}  // namespace stratum::march
