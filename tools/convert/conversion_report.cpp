#include "convert/conversion_steps.h"

#include "convert/reports.h"

#include "compare/comparison_report.h"
#include "voxelize/grid/solid_check.h"

#include <fmt/format.h>

#include <span>
#include <string>
#include <system_error>

namespace stratum::tools {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void Conversion::check(const ConversionJob& job, GridNumbers& numbers) {
    const auto printed = std::span<const std::uint32_t>(plan_->selection()).first(job.beads);
    numbers.deposited_mm3 = voxelize::depositedVolume(toolpath_, printed);
    const std::string doubt = doubtOf(numbers.enclosed_mm3, numbers.deposited_mm3, provenance_.culled);
    if (!doubt.empty()) warn(fmt::format("{}: {}", file_.name(), doubt));
    seconds_.check += watch_.lap();
}

void Conversion::tellOutput(const voxelize::Voxelizer& voxelizer, const ConversionJob& job, const GridNumbers& grid) {
    std::error_code stream;
    const bool on_disk = fs::is_regular_file(job.path, stream);
    const auto bytes = on_disk ? fs::file_size(job.path) : 0;
    const exporter::GridStatistics& counted = grid.counted.statistics;
    files_.push_back({{"path", job.path.string()},
                      {"snapshot", job.label},
                      {"bytes", on_disk ? nlohmann::ordered_json(bytes) : nullptr},
                      {"beads", job.beads},
                      {"active_voxels", counted.active_voxels},
                      {"leaves_evaluated", voxelizer.report().leaves_evaluated},
                      {"leaves_reused", voxelizer.report().leaves_reused}});
    say(o_.common, fmt::format("  {}: {} active voxels, {} in memory{}", job.path.string(),
                               humanCount(static_cast<double>(counted.active_voxels)),
                               humanBytes(static_cast<double>(counted.memory_bytes)),
                               on_disk ? fmt::format(", {} on disk", humanBytes(static_cast<double>(bytes))) : ""));
}

void Conversion::tellMesh(const exporter::SurfaceMesh& mesh, const openvdb::FloatGrid& grid) {
    files_.back()["mesh"] = describeMesh(mesh, grid, plan_->lattice());
    std::string text = fmt::format("  {} triangles", humanCount(static_cast<double>(mesh.triangleCount())));
    if (o_.mesh_faces > 0)
        text += fmt::format(", at most {:.2g} mm from the surface", mesh.error * plan_->lattice().voxel_size);
    if (o_.mesh_faces > 0 && mesh.triangleCount() > o_.mesh_faces)
        text += fmt::format("; {} would take what hangs together apart", o_.mesh_faces);
    say(o_.common, text);
}

void Conversion::tellDeposit(const voxelize::Voxelizer& voxelizer, double surface_mm3) {
    if (!settles() || !(stats() || o_.summary)) return;
    const voxelize::DepositBalance balance = voxelizer.balance();
    if (o_.summary) say(o_.common, depositLines(balance));
    if (stats()) deposit_ = describeDeposit(toolpath_.deposit, balance, surface_mm3);
}

void Conversion::describeWhole(const voxelize::Voxelizer& voxelizer, const GridNumbers& grid, double surface_mm3) {
    tellDeposit(voxelizer, surface_mm3);
    if (stats()) grid_ = describeGrid(grid, plan_->lattice());
}

Json Conversion::skipped(const voxelize::VoxelizeReport& built) const {
    Json skipped = Json::array();
    const auto skip = [&skipped](const char* what, const std::string& why, const std::string& saved) {
        skipped.push_back({{"what", what}, {"why", why}, {"saved", saved}});
    };
    if (plan_->selection().size() < toolpath_.beads.size()) {
        const std::string why = provenance_.selection.empty() ? "prime lines before layer 1 (--layers 0: keeps them)"
                                                              : provenance_.selection;
        const std::string count =
            fmt::format("{} of {} beads", toolpath_.beads.size() - plan_->selection().size(), toolpath_.beads.size());
        skip("beads", why, count);
        say(o_.common, fmt::format("  left out {}: {}", count, why));
    }
    if (!settles())
        skip("settling", "beads are capsules (--beads settled)", "pairs of neighbouring beads in each plan field");
    if (!flow_) skip("flow", "beads have their commanded widths (--flow-lag)", "a plan of the motion, and more beads");
    if (!comparison_)
        skip("the model", "no model to compare with (--compare)", "the outside as polygons, and their distances");
    if (!o_.interior_distance)
        skip("distances inside the solid", "the surface needs only their sign", "a fast-sweeping pass over the grid");
    if (attributes_.empty())
        skip("attribute grids", "none asked for (--grids)", "a nearest-bead search and four bytes a voxel for each");
    if (streams()) skip("the grid in memory", "only its file is wanted", "a leaf of 2 kB for each that is in the file");
    if (!o_.report.asked()) skip("the report", "not asked for (--report)", "floods and passes over a grid in memory");
    if (!o_.forecast && !culls())
        skip("what --interior cull would save", "not asked for (--forecast)",
             "a flood through all leaves, about a third of a build");
    if (culls())
        skip("leaves that the outside can't reach", "--interior cull",
             fmt::format("{} of {} leaf positions were never evaluated", built.leaf_positions - built.leaves_evaluated,
                         built.leaf_positions));
    return skipped;
}

Json Conversion::report(const Json& left_out, int threads, double total) const {
    Json toolpath_report = describeToolpath(toolpath_);
    toolpath_report["selected_bbox_mm"] = {plan_->lyingBounds().min, plan_->lyingBounds().max};
    return {{"input",
             {{"path", input_},
              {"bytes", file_.bytes().size()},
              {"sha256", sha256_},
              {"slicer", toolpath_.slicer},
              {"format", toolpath_.format}}},
            {"toolpath", toolpath_report},
            {"time", times_ ? describeTimes(*times_, estimate_, toolpath_.stated) : Json(nullptr)},
            {"grid", grid_},
            {"deposit", deposit_},
            {"flow", flow_ ? describeFlow(*flow_) : Json(nullptr)},
            {"sag", sag_ ? describeSag(*sag_) : Json(nullptr)},
            {"compare", comparison_ ? compare::describe(comparison_->found) : Json(nullptr)},
            {"files", files_},
            {"skipped", left_out},
            {"seconds",
             {{"parse", seconds_.parse},
              {"cull", seconds_.cull},
              {"voxelize", seconds_.voxelize - seconds_.cull},
              {"mesh", seconds_.mesh},
              {"write", seconds_.write},
              {"volume", seconds_.check},
              {"compare", seconds_.compare},
              {"report", seconds_.report},
              {"total", total}}},
            {"peak_rss_bytes", peakRssBytes()},
            {"threads", threads}};
}

}  // namespace stratum::tools
