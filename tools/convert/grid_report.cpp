#include "convert/reports.h"

#include "voxelize/beads/estimate.h"
#include "voxelize/grid/solid_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace stratum::tools {

using Json = nlohmann::ordered_json;

GridNumbers numbersOf(const openvdb::FloatGrid& grid) {
    GridNumbers numbers;
    numbers.transform = grid.transformPtr();
    numbers.counted.leaves = grid.tree().leafCount();
    numbers.counted.statistics = {grid.evalActiveVoxelBoundingBox(), grid.activeVoxelCount(), grid.memUsage()};
    return numbers;
}

Json describeGrid(const GridNumbers& grid, const voxelize::Lattice& lattice) {
    const exporter::GridStatistics& counted = grid.counted.statistics;
    const openvdb::BBoxd box = grid.transform->indexToWorld(
        openvdb::BBoxd(counted.active_box.min().asVec3d(), counted.active_box.max().asVec3d()));
    const openvdb::Vec3d low = box.min();
    const openvdb::Vec3d high = box.max();
    const double unit = grid.transform->voxelSize()[0] / lattice.voxel_size;
    return {
        {"voxel_size_mm", lattice.voxel_size},
        {"half_width", lattice.half_width},
        {"layer_height_mm", lattice.layer_height},
        {"aligned_share", lattice.aligned_share},
        {"choice", lattice.reason},
        {"active_voxels", counted.active_voxels},
        {"leaves", grid.counted.leaves},
        {"bytes", counted.memory_bytes},
        {"bbox_mm", {{low[0] / unit, low[1] / unit, low[2] / unit}, {high[0] / unit, high[1] / unit, high[2] / unit}}},
        {"volume_mm3", grid.enclosed_mm3},
        {"volume_leaves", grid.enclosed_of_leaves},
        {"deposited_mm3", grid.deposited_mm3}};
}

Json describeCull(const voxelize::Voxelizer& voxelizer, const openvdb::FloatGrid& grid) {
    const voxelize::CullForecast left = voxelizer.forecastCull();
    const std::size_t leaves = grid.tree().leafCount() - left.leaves;
    return {{"active_voxels", grid.activeVoxelCount() - left.active_voxels},
            {"leaves", leaves},
            {"bytes", leaves * static_cast<std::size_t>(voxelize::kBytesPerLeaf)}};
}

Json describeDeposit(const gcode::DepositModel& deposit, const voxelize::DepositBalance& balance, double surface_mm3) {
    Json features = Json::object();
    for (std::size_t f = 0; f < balance.features.size(); ++f) {
        const voxelize::DepositShare& share = balance.features[f];
        if (share.fed > 0)
            features[std::string(gcode::featureName(static_cast<gcode::Feature>(f)))] = {
                {"fed_mm3", share.fed}, {"laid_mm3", share.laid}, {"surplus_mm3", share.surplus()}};
    }
    return {{"model", gcode::describe(deposit)},
            {"fed_mm3", balance.all.fed},
            {"laid_mm3", balance.held()},
            {"pressed_out_mm3", balance.pressed_out},
            {"raised_mm3", balance.raised},
            {"shared_mm3", balance.shared},
            {"surface_mm3", surface_mm3},
            {"surplus_mm3", balance.unplaced()},
            {"features", features}};
}

std::string depositLines(const voxelize::DepositBalance& balance) {
    // What rounds to nothing has no sign.
    const auto rounded = [](double value, double places) { return std::round(value * places) / places + 0.0; };
    std::string lines = fmt::format(
        "settled: {:.2f} of {:.2f} mm^3 laid, {:.2f} of them press outlines out, {:.2f} raise tops; {:.2f} mm^3 "
        "({:.2f} %) have no place\n",
        balance.held(), balance.all.fed, balance.pressed_out, balance.raised, balance.unplaced(),
        100 * balance.unplaced() / balance.all.fed);
    for (std::size_t f = 0; f < balance.features.size(); ++f) {
        const voxelize::DepositShare& share = balance.features[f];
        if (share.fed > 0)
            lines += fmt::format("  {:<20} {:>9.2f} mm^3 fed {:>8.2f} surplus ({:.1f} %)\n",
                                 gcode::featureName(static_cast<gcode::Feature>(f)), share.fed,
                                 rounded(share.surplus(), 100), rounded(100 * share.surplus() / share.fed, 10));
    }
    return lines;
}

Json describeMesh(const exporter::SurfaceMesh& mesh, const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice) {
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    return {{"vertices", mesh.points.size()},
            {"triangles", mesh.triangleCount()},
            {"volume_mm3", mesh.volume() / (unit * unit * unit)}};
}

double enclosedMm3(const openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, bool exact) {
    const double unit = grid.voxelSize()[0] / lattice.voxel_size;
    const double volume =
        exact ? voxelize::enclosedVolume(grid) : voxelize::enclosedVolume(grid, voxelize::kVolumeSample);
    return volume / (unit * unit * unit);
}

std::string doubtOf(double enclosed_mm3, double deposited_mm3, bool culled) {
    const double excess = enclosed_mm3 / deposited_mm3 - 1;
    if (excess >= -voxelize::kVolumeDoubt && (culled || excess <= voxelize::kVolumeDoubt)) return {};
    return fmt::format("the level set holds {:.3g} cm3, {:.0f} % {} than the {:.3g} cm3 of its beads: {}",
                       enclosed_mm3 * 1e-3, 100 * std::abs(excess), excess < 0 ? "less" : "more", deposited_mm3 * 1e-3,
                       excess < 0 ? "they overlap that much, or are thinner than a voxel"
                                  : "gaps between them are narrower than a voxel, or their round ends hold more than "
                                    "was fed, as those of short beads do");
}

}  // namespace stratum::tools
