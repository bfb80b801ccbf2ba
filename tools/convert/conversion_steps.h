// One conversion of gcode2vdb, step by step: what each step finds, and which comes after which.
#pragma once

#include "convert/conversion.h"
#include "convert/model_comparison.h"
#include "convert/reports.h"
#include "progress.h"

#include "deposit/read_print.h"
#include "export/mesh/surface_mesh.h"
#include "export/plan/level_set_plan.h"
#include "gcode/container/container.h"
#include "gcode/toolpath/toolpath.h"
#include "motion/print_times.h"
#include "voxelize/grid/voxelizer.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {

/// One output: the whole selection, or what of it a snapshot has printed.
struct ConversionJob {
    std::string label;
    std::filesystem::path path;
    std::size_t beads = 0;  ///< of the selection
    std::uint32_t end = 0;  ///< all selected beads before this one
};

/// Each method needs what those before it found.
class Conversion {
public:
    Conversion(const ConvertCommand& command, const std::string& input, const std::filesystem::path& output,
               RunFiles& files_of_run);
    nlohmann::ordered_json run(int threads);

private:
    using Json = nlohmann::ordered_json;
    struct Seconds {
        double parse = 0, voxelize = 0, cull = 0, mesh = 0, write = 0, check = 0, compare = 0, report = 0;
    };

    bool culls() const { return plan_->culls(); }
    bool settles() const { return toolpath_.deposit.settles(); }
    bool stats() const { return !o_.common.stats.empty(); }
    // Whether nothing needs the grid in memory: its leaves then go to the file while they are made.
    bool streams() const;
    // Whether outputs are compared with what was extruded: nobody would read it otherwise.
    bool checks() const { return !o_.common.quiet || stats(); }
    void warn(const std::string& text) const;

    // conversion.cpp: up to the first output.
    void read();
    void tell() const;
    void choose();
    Json finish(const Json& left_out, int threads);
    std::vector<ConversionJob> planJobs() const;
    voxelize::VoxelizeOptions voxelizeOptions();

    // conversion_outputs.cpp: one output, from its voxels to its lines of the report.
    void makeElements();
    void make(voxelize::Voxelizer& voxelizer, const ConversionJob& job);
    void makeStreamed(voxelize::Voxelizer& voxelizer, const ConversionJob& job);
    void makeInMemory(voxelize::Voxelizer& voxelizer, const ConversionJob& job);
    void makeReport(const openvdb::FloatGrid& grid);
    exporter::SurfaceMesh writeMesh(const openvdb::FloatGrid& grid, const openvdb::GridPtrVec& grids,
                                    const ConversionJob& job);
    void writeGrids(const openvdb::FloatGrid::Ptr& grid, openvdb::GridPtrVec& grids, const ConversionJob& job);
    void writeUsda(const openvdb::GridPtrVec& grids, const ConversionJob& job) const;

    // conversion_report.cpp: what is told, on the terminal and in --stats.
    // Whether the level set holds what its beads lay.
    void check(const ConversionJob& job, GridNumbers& numbers);
    void tellOutput(const voxelize::Voxelizer& voxelizer, const ConversionJob& job, const GridNumbers& grid);
    void tellMesh(const exporter::SurfaceMesh& mesh, const openvdb::FloatGrid& grid);
    // Reports that cost time: only of the whole print, and only if somebody reads them. `surface_mm3`: what the level
    // set of settled beads encloses, if that is asked for.
    void tellDeposit(const voxelize::Voxelizer& voxelizer, double surface_mm3);
    void describeWhole(const voxelize::Voxelizer& voxelizer, const GridNumbers& grid, double surface_mm3);
    Json skipped(const voxelize::VoxelizeReport& built) const;
    Json report(const Json& left_out, int threads, double total) const;

    const ConvertCommand& o_;
    const std::string& input_;
    const std::filesystem::path& output_;
    RunFiles& files_of_run_;
    Stopwatch total_, watch_;
    Seconds seconds_;
    const gcode::InputBytes file_;
    std::string sha256_;  // of the file; empty if nobody asks
    std::optional<motion::PrintTimes> times_;
    std::optional<motion::PrintTimes> estimate_;  // by the slicer's own rule, where the firmware has another
    std::optional<deposit::FlowReport> flow_;
    std::optional<deposit::SagReport> sag_;
    gcode::Toolpath toolpath_;
    bool as_mesh_ = false;
    std::optional<exporter::LevelSetPlan> plan_;
    std::vector<voxelize::Attribute> attributes_;  // the plan's, or the mesh's
    exporter::Provenance provenance_;              // of the output that is being made
    std::optional<ProgressBar> bar_;
    Json files_ = Json::array();
    Json grid_, deposit_;
    std::optional<ModelComparison> comparison_;
};

}  // namespace stratum::tools
