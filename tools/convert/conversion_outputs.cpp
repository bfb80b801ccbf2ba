#include "convert/conversion_steps.h"

#include "convert/elements_output.h"
#include "convert/mesh_output.h"

#include "base/checksum.h"
#include "base/error.h"
#include "export/mesh_file.h"
#include "export/nano_file.h"
#include "export/usd_file.h"
#include "export/vdb_file.h"
#include "export/vdb_stream.h"
#include "report/print_report.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/solid_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace stratum::tools {

// Solid elements instead of a level set.
void Conversion::makeElements() {
    if (stats()) sha256_ = sha256Hex(file_.bytes());
    files_.push_back(
        writeElements(o_, toolpath_, plan_->selection(), plan_->lattice(), plan_->placement(), file_.name(), output_));
    seconds_.write = watch_.lap();
}

void Conversion::make(voxelize::Voxelizer& voxelizer, const ConversionJob& job) {
    watch_.lap();
    provenance_ = plan_->provenance(std::filesystem::path(file_.name()).filename().string(), sha256_,
                                    std::span(plan_->selection()).first(job.beads));
    provenance_.snapshot = job.label;
    if (streams())
        makeStreamed(voxelizer, job);
    else
        makeInMemory(voxelizer, job);
}

void Conversion::makeStreamed(voxelize::Voxelizer& voxelizer, const ConversionJob& job) {
    const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
    exporter::describe(*empty, plan_->lattice(), provenance_);
    bar_.emplace("voxelizing", o_.common.quiet);
    const voxelize::LeafBounds bounds = voxelizer.leafBounds();
    exporter::VdbStream file(empty, job.path, o_.file, bounds);
    const voxelize::LeafStreamReport made = voxelizer.stream(job.end, bounds, file, checks());
    bar_.reset();
    seconds_.voxelize += watch_.lap();
    GridNumbers numbers;
    {
        const ProgressNote note("writing", o_.common.quiet);
        numbers.counted = file.finish();
        writeUsda({empty}, job);
    }
    seconds_.write += watch_.lap();
    numbers.transform = empty->transformPtr();
    numbers.enclosed_mm3 = made.volume_voxels * std::pow(plan_->lattice().voxel_size, 3);
    numbers.enclosed_of_leaves = made.measured;
    if (checks()) check(job, numbers);
    tellOutput(voxelizer, job, numbers);
    if (checks()) describeWhole(voxelizer, numbers, 0);
}

void Conversion::makeInMemory(voxelize::Voxelizer& voxelizer, const ConversionJob& job) {
    bar_.emplace("voxelizing", o_.common.quiet);
    openvdb::FloatGrid::Ptr grid = voxelizer.printUntil(job.end);
    if (!attributes_.empty()) bar_.emplace("grids", o_.common.quiet);
    openvdb::GridPtrVec grids = voxelizer.attributes(attributes_);
    bar_.reset();
    if (o_.interior_distance) {
        const ProgressNote note("distances", o_.common.quiet);
        // The voxelizer goes on from its own values.
        if (!job.label.empty() || o_.forecast) grid = grid->deepCopy();
        voxelize::sweepInterior(*grid);
    }
    seconds_.voxelize += watch_.lap();
    seconds_.cull += voxelizer.report().exterior_seconds;
    std::optional<exporter::SurfaceMesh> mesh;
    if (as_mesh_)
        mesh = writeMesh(*grid, grids, job);
    else if (o_.writesGrid())
        writeGrids(grid, grids, job);
    seconds_.write += watch_.lap();
    if (o_.report.asked() && job.label.empty()) makeReport(*grid);
    GridNumbers numbers = numbersOf(*grid);
    if (checks()) {
        const ProgressNote note("measuring", o_.common.quiet);
        numbers.enclosed_mm3 = enclosedMm3(*grid, plan_->lattice());
        numbers.enclosed_of_leaves = std::min<std::size_t>(numbers.counted.leaves, voxelize::kVolumeSample);
        check(job, numbers);
    }
    if (o_.writesGrid()) tellOutput(voxelizer, job, numbers);
    if (mesh) tellMesh(*mesh, *grid);
    if (!checks() || !job.label.empty()) return;
    const bool exact = settles() && stats();
    describeWhole(voxelizer, numbers, exact ? enclosedMm3(*grid, plan_->lattice(), true) : 0);
    if (stats() && o_.forecast && !culls()) grid_["cull_would_save"] = describeCull(voxelizer, *grid);
}

void Conversion::makeReport(const openvdb::FloatGrid& grid) {
    const ProgressNote note("report", o_.common.quiet);
    report::ReportOptions options{provenance_.source_file, provenance_.selection, culls(), o_.report.density,
                                  o_.report.price};
    writeReports(o_.report, report::makeReport(grid, toolpath_, plan_->selection(), plan_->lattice(), times_, options));
    seconds_.report = watch_.lap();
}

exporter::SurfaceMesh Conversion::writeMesh(const openvdb::FloatGrid& grid, const openvdb::GridPtrVec& grids,
                                            const ConversionJob& job) {
    exporter::SurfaceMesh mesh = [&] {
        const ProgressNote note("meshing", o_.common.quiet);
        return meshOf(o_, grid, grids, provenance_.culled, materialsOf(toolpath_, plan_->selection()), output_);
    }();
    seconds_.mesh += watch_.lap();
    if (mesh.faces.empty() && job.label.empty())
        throw UsageError(
            fmt::format("{}: the mesh has no triangles: all beads are finer than the voxels of {:g} mm; "
                        "choose smaller ones, --voxel-size",
                        job.path.string(), plan_->lattice().voxel_size));
    const ProgressNote note("writing", o_.common.quiet);
    exporter::writeMesh(mesh, job.path, {voxelize::millimetresIn(o_.unit), o_.up == "y"});
    return mesh;
}

void Conversion::writeGrids(const openvdb::FloatGrid::Ptr& grid, openvdb::GridPtrVec& grids, const ConversionJob& job) {
    const ProgressNote note("writing", o_.common.quiet);
    exporter::describe(*grid, plan_->lattice(), provenance_);
    if (o_.compare.grid)
        grids.push_back(
            compare::deviationGrid(*grid, *voxelize::makeTransform(plan_->lattice(), voxelize::placementOf(toolpath_)),
                                   *comparison_->model, comparison_->found));
    grids.insert(grids.begin(), grid);
    if (exporter::isNanoPath(job.path))
        exporter::writeNano(grids, job.path, o_.file);
    else
        exporter::writeVdb(grids, job.path, o_.file);
    writeUsda(grids, job);
}

void Conversion::writeUsda(const openvdb::GridPtrVec& grids, const ConversionJob& job) const {
    if (o_.usda)
        exporter::writeUsda(
            grids, job.path, usdaOf(job.path),
            {0.001 * voxelize::millimetresIn(o_.unit), o_.up == "y", materialsOf(toolpath_, plan_->selection())});
}

}  // namespace stratum::tools
