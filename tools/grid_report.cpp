#include "grid_report.h"

#include "voxelize/enclosed_volume.h"
#include "voxelize/estimate.h"

namespace stratum::tools {

using Json = nlohmann::ordered_json;

Json describeGrid(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const openvdb::Vec3d a = grid.indexToWorld(box.min());
    const openvdb::Vec3d b = grid.indexToWorld(box.max());
    const openvdb::Vec3d low = openvdb::math::minComponent(a, b);
    const openvdb::Vec3d high = openvdb::math::maxComponent(a, b);
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    return {
        {"voxel_size_mm", lattice.voxel_size},
        {"half_width", lattice.half_width},
        {"layer_height_mm", lattice.layer_height},
        {"aligned_share", lattice.aligned_share},
        {"choice", lattice.reason},
        {"active_voxels", grid.activeVoxelCount()},
        {"leaves", grid.tree().leafCount()},
        {"bytes", grid.memUsage()},
        {"bbox_mm", {{low[0] / unit, low[1] / unit, low[2] / unit}, {high[0] / unit, high[1] / unit, high[2] / unit}}},
        {"volume_mm3", voxelize::enclosedVolume(grid) / (unit * unit * unit)}};
}

Json describeCull(const voxelize::Voxelizer& voxelizer, const openvdb::FloatGrid& grid) {
    const voxelize::CullForecast left = voxelizer.forecastCull();
    const std::size_t leaves = grid.tree().leafCount() - left.leaves;
    return {{"active_voxels", grid.activeVoxelCount() - left.active_voxels},
            {"leaves", leaves},
            {"bytes", leaves * static_cast<std::size_t>(voxelize::kBytesPerLeaf)}};
}

Json describeMesh(const voxelize::SurfaceMesh& mesh, const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice) {
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    return {{"vertices", mesh.points.size()},
            {"triangles", mesh.triangleCount()},
            {"volume_mm3", mesh.volume() / (unit * unit * unit)}};
}

}  // namespace stratum::tools
