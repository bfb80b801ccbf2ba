#include "convert/conversion.h"

#include "convert/convert_shard.h"
#include "convert/elements_output.h"
#include "convert/grid_report.h"
#include "convert/mesh_output.h"
#include "convert/model_comparison.h"
#include "convert/time_report.h"
#include "convert/toolpath_report.h"
#include "print_options.h"
#include "progress.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "compare/comparison_report.h"
#include "deposit/read_print.h"
#include "export/mesh_file.h"
#include "export/nano_file.h"
#include "export/parts/part_file.h"
#include "export/surface_mesh.h"
#include "export/usd_file.h"
#include "export/vdb_file.h"
#include "export/vdb_stream.h"
#include "gcode/container/input_bytes.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/summary.h"
#include "gcode/toolpath/toolpath_csv.h"
#include "gcode/toolpath/warning_log.h"
#include "voxelize/beads/part_bounds.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/attributes.h"
#include "voxelize/grid/enclosed_volume.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// One output: the whole selection, or what of it a snapshot has printed.
struct Job {
    std::string label;
    fs::path path;
    std::size_t beads = 0;  // of the selection
    std::uint32_t end = 0;  // all selected beads before this one
};

std::vector<Job> planJobs(const ConvertCommand& o, const gcode::Toolpath& toolpath,
                          const std::vector<std::uint32_t>& selection, const fs::path& output) {
    std::vector<Job> jobs;
    if (!o.snapshots.empty()) {
        for (const voxelize::Snapshot& snapshot : voxelize::parseSnapshots(o.snapshots, toolpath)) {
            fs::path path = output;
            path.replace_filename(
                fmt::format("{}_{}{}", output.stem().string(), snapshot.label, output.extension().string()));
            const auto end = static_cast<std::uint32_t>(snapshot.bead_count);
            const auto beads = std::lower_bound(selection.begin(), selection.end(), end) - selection.begin();
            if (beads > 0) jobs.push_back({snapshot.label, path, static_cast<std::size_t>(beads), end});
        }
    }
    jobs.push_back({"", output, selection.size(), static_cast<std::uint32_t>(toolpath.beads.size())});
    return jobs;
}

// Whether anything asks when beads are laid.
bool needsTimes(const ConvertCommand& o) {
    const std::vector<voxelize::Attribute> grids = voxelize::parseGrids(o.grids);
    return o.summary || o.report.asked() || !o.common.stats.empty() || voxelize::needsTiming(o.snapshots) ||
           std::any_of(grids.begin(), grids.end(), voxelize::usesTiming);
}

/// One input, step by step: each method needs what those before it found.
class Conversion {
public:
    Conversion(const ConvertCommand& command, const std::string& input, const fs::path& output, RunFiles& files_of_run,
               std::optional<exporter::PartOfPrint> part)
        : o_(command),
          input_(input),
          output_(output),
          files_of_run_(files_of_run),
          part_(std::move(part)),
          file_(input) {}

    Json run(int threads) {
        read();
        tell();
        choose();
        if (isElementsPath(output_)) return makeElements(threads);
        describeSource();
        voxelize::VoxelizeOptions options = voxelizeOptions();
        placement_ = options.placement;
        voxelize::Voxelizer voxelizer(toolpath_, selection_, lattice_, std::move(options));
        seconds_.voxelize += watch_.lap();
        if (!o_.compare.model.empty()) comparison_ = compareWithModel(o_, toolpath_, selection_, lattice_);
        seconds_.compare = watch_.lap();
        const std::vector<Job> jobs = planJobs(o_, toolpath_, selection_, output_);
        for (const Job& job : jobs)
            if (!job.label.empty()) {
                noteOutput(o_, job.path, "--snapshots", files_of_run_);
                if (o_.usda) files_of_run_.writes(usdaOf(job.path).string(), "--usda");
            }
        for (const Job& job : jobs) make(voxelizer, job);
        const double total = total_.lap();
        say(o_.common, fmt::format("  done in {:.2f} s", total));
        return o_.common.stats.empty() ? Json() : report(skipped(voxelizer.report()), threads, total);
    }

private:
    struct Seconds {
        double parse = 0, voxelize = 0, cull = 0, mesh = 0, write = 0, check = 0, compare = 0, report = 0;
    };

    bool culls() const { return interior_ == voxelize::Interior::cull; }
    // Whether nothing needs the grid in memory: its leaves then go to the file while they are made.
    bool streams() const {
        return !as_mesh_ && !exporter::isNanoPath(output_) && !culls() && attributes_.empty() && !o_.compare.grid &&
               o_.snapshots.empty() && !o_.interior_distance && !o_.forecast && !o_.report.asked() &&
               (part_ || !(settles() && !o_.common.stats.empty()));
    }
    bool settles() const { return toolpath_.deposit.settles(); }
    void warn(const std::string& text) const {
        if (!o_.common.quiet) fmt::print(stderr, "gcode2vdb: {}\n", text);
    }

    void read() {
        gcode::ReadOptions read = o_.print.read;
        ProgressBar bar("reading", o_.common.quiet);
        read.progress = bar.callback();
        deposit::PrintRead print = deposit::readPrint(file_.bytes(), file_.name(), read, needsTimes(o_));
        toolpath_ = std::move(print.toolpath);
        times_ = std::move(print.times);
        flow_ = print.flow;
        sag_ = print.sag;
        seconds_.parse = watch_.lap();
    }

    void tell() const {
        for (const gcode::Warning& warning : toolpath_.warnings) warn(gcode::describe(warning, file_.name()));
        if (!o_.dump_toolpath.empty()) gcode::writeToolpathCsv(toolpath_, o_.dump_toolpath);
        if (o_.common.quiet) return;
        say(o_.common, fmt::format("{}: {}, {} layers, {} beads ({} arcs), {:.2f} m of filament, {:.2f} cm3",
                                   file_.name(), toolpath_.slicer.empty() ? "unknown slicer" : toolpath_.slicer,
                                   toolpath_.layer_count, toolpath_.beads.size(), toolpath_.arcs.size(),
                                   toolpath_.filament_mm * 1e-3, gcode::beadVolume(toolpath_) * 1e-3));
        if (o_.summary) say(o_.common, gcode::summarize(toolpath_) + timeLines(*times_, toolpath_.stated));
        if (o_.summary && flow_) say(o_.common, flowLine(*flow_));
        if (o_.summary && sag_) say(o_.common, sagLine(*sag_));
    }

    // Solid elements instead of a level set.
    Json makeElements(int threads) {
        provenance_.source_sha256 = o_.common.stats.empty() ? "" : sha256Hex(file_.bytes());
        files_.push_back(writeElements(o_, toolpath_, selection_, lattice_,
                                       voxelize::placementOf(o_.unit, o_.up, o_.origin, bounds_), file_.name(),
                                       output_));
        seconds_.write = watch_.lap();
        const double total = total_.lap();
        say(o_.common, fmt::format("  done in {:.2f} s", total));
        return o_.common.stats.empty() ? Json()
                                       : report({{{"what", "the level set"},
                                                  {"why", "elements need its signs alone"},
                                                  {"saved", "leaves, their grid and file"}}},
                                                threads, total);
    }

    // Beads, grids and the lattice.
    void choose() {
        selection_ = voxelize::selectBeads(toolpath_, voxelize::selectionOf(o_.print, toolpath_));
        selected_beads_ = selection_.size();
        bounds_ = voxelize::boundsOf(toolpath_, selection_);
        as_mesh_ = exporter::isMeshPath(output_);
        if (o_.interior == "cull" || (o_.interior.empty() && as_mesh_)) interior_ = voxelize::Interior::cull;
        attributes_ = voxelize::parseGrids(o_.grids);
        colors_ = gcode::distinctColors(toolpath_, selection_);
        if (as_mesh_) attributes_ = meshAttributes(o_, toolpath_, selection_, output_);
        if (colors_.size() > 1 && o_.grids.empty() && !as_mesh_) {
            if (part_)
                throw UsageError(fmt::format(
                    "--shard: the print has {} colors of filament, and a color grid is made of the whole print; leave "
                    "it out with --grids surface, or make it without --shard",
                    colors_.size()));
            attributes_.push_back(voxelize::Attribute::color);
            say(o_.common,
                fmt::format("  {} colors of filament: a color grid, too (--grids surface: none)", colors_.size()));
        }
        lattice_ = voxelize::latticeFor(o_.print, toolpath_, selection_, bounds_, interior_);
        say(o_.common, fmt::format("  voxel {:g} mm ({}); {:.0f} % of the length lies on voxel planes",
                                   lattice_.voxel_size, lattice_.reason, lattice_.aligned_share * 100));
        // Elements are chosen for what a solver can take, not for layer lines; they say what volume they hold.
        if (!lattice_.warning.empty() && !isElementsPath(output_))
            warn(fmt::format("{}: {}", file_.name(), lattice_.warning));
    }

    void describeSource() {
        provenance_.source_file = fs::path(file_.name()).filename().string();
        provenance_.source_sha256 = sha256Hex(file_.bytes());
        provenance_.slicer = toolpath_.slicer;
        provenance_.unit = o_.unit;
        provenance_.up = o_.up;
        provenance_.selection = voxelize::describeSelection(o_.print);
        if (colors_.size() == 1 && colors_.front()) {
            const auto [red, green, blue] = *colors_.front();
            provenance_.filament_color = fmt::format("#{:02X}{:02X}{:02X}", red, green, blue);
        }
        provenance_.culled = culls();
        provenance_.deposit = toolpath_.deposit;
        provenance_.swept = o_.interior_distance;
    }

    voxelize::VoxelizeOptions voxelizeOptions() {
        voxelize::VoxelizeOptions options;
        options.placement = voxelize::placementOf(o_.unit, o_.up, o_.origin, bounds_);
        options.interior = interior_;
        options.in_memory = !streams();
        if (part_) options.shard = part_->shard;
        if (showsProgress(o_.common.quiet))
            options.progress = [this](double fraction) {
                if (bar_) bar_->show(fraction);
            };
        return options;
    }

    // One output, from its voxels to its lines of the report.
    void make(voxelize::Voxelizer& voxelizer, const Job& job) {
        watch_.lap();
        provenance_.snapshot = job.label;
        const auto printed = std::span<const std::uint32_t>(selection_).first(job.beads);
        provenance_.part = voxelize::placed(voxelize::partBounds(toolpath_, printed), placement_);
        if (streams())
            makeStreamed(voxelizer, job);
        else
            makeInMemory(voxelizer, job);
    }

    // Nobody would read it otherwise; and a part does not hold what all beads lay.
    bool checks() const { return !part_ && (!o_.common.quiet || !o_.common.stats.empty()); }

    void makeStreamed(voxelize::Voxelizer& voxelizer, const Job& job) {
        const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
        exporter::describe(*empty, lattice_, provenance_);
        bar_.emplace("voxelizing", o_.common.quiet);
        const voxelize::LeafBounds bounds = voxelizer.leafBounds();
        if (part_) {
            part_->blocks = voxelizer.blocks();
            part_->print = bounds.print;
        }
        exporter::VdbStream file(empty, job.path, o_.file, bounds, part_);
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
        numbers.enclosed_mm3 = made.volume_voxels * std::pow(lattice_.voxel_size, 3);
        numbers.enclosed_of_leaves = made.measured;
        if (checks()) check(job, numbers);
        tellOutput(voxelizer, job, numbers);
        if (checks()) describeWhole(voxelizer, numbers, 0);
    }

    void makeInMemory(voxelize::Voxelizer& voxelizer, const Job& job) {
        bar_.emplace("voxelizing", o_.common.quiet);
        openvdb::FloatGrid::Ptr grid = voxelizer.printUntil(job.end);
        if (!attributes_.empty()) bar_.emplace("grids", o_.common.quiet);
        openvdb::GridPtrVec grids = voxelizer.attributes(attributes_);
        bar_.reset();
        if (o_.interior_distance) {
            const ProgressNote note("distances", o_.common.quiet);
            // The voxelizer goes on from its own values at the next step.
            grid = grid->deepCopy();
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
            numbers.enclosed_mm3 = enclosedMm3(*grid, lattice_);
            numbers.enclosed_of_leaves = std::min<std::size_t>(numbers.counted.leaves, voxelize::kVolumeSample);
            check(job, numbers);
        }
        if (o_.writesGrid()) tellOutput(voxelizer, job, numbers);
        if (mesh) tellMesh(*mesh, *grid);
        if (!checks() || !job.label.empty()) return;
        const bool exact = settles() && !o_.common.stats.empty();
        describeWhole(voxelizer, numbers, exact ? enclosedMm3(*grid, lattice_, true) : 0);
        if (!o_.common.stats.empty() && o_.forecast && !culls())
            grid_["cull_would_save"] = describeCull(voxelizer, *grid);
    }

    void makeReport(const openvdb::FloatGrid& grid) {
        const ProgressNote note("report", o_.common.quiet);
        report::ReportOptions options{provenance_.source_file, provenance_.selection, culls(), o_.report.density,
                                      o_.report.price};
        writeReports(o_.report, report::makeReport(grid, toolpath_, selection_, lattice_, times_, options));
        seconds_.report = watch_.lap();
    }

    // Whether the level set holds what its beads lay.
    void check(const Job& job, GridNumbers& numbers) {
        const auto printed = std::span<const std::uint32_t>(selection_).first(job.beads);
        numbers.deposited_mm3 = voxelize::depositedVolume(toolpath_, printed);
        const std::string doubt = doubtOf(numbers.enclosed_mm3, numbers.deposited_mm3, provenance_.culled);
        if (!doubt.empty()) warn(fmt::format("{}: {}", file_.name(), doubt));
        seconds_.check += watch_.lap();
    }

    exporter::SurfaceMesh writeMesh(const openvdb::FloatGrid& grid, const openvdb::GridPtrVec& grids, const Job& job) {
        exporter::SurfaceMesh mesh = [&] {
            const ProgressNote note("meshing", o_.common.quiet);
            return meshOf(o_, grid, grids, provenance_.culled, materialsOf(toolpath_, selection_), output_);
        }();
        seconds_.mesh += watch_.lap();
        const ProgressNote note("writing", o_.common.quiet);
        exporter::writeMesh(mesh, job.path, {voxelize::millimetresIn(o_.unit), o_.up == "y"});
        return mesh;
    }

    void writeGrids(const openvdb::FloatGrid::Ptr& grid, openvdb::GridPtrVec& grids, const Job& job) {
        const ProgressNote note("writing", o_.common.quiet);
        exporter::describe(*grid, lattice_, provenance_);
        if (o_.compare.grid)
            grids.push_back(compare::deviationGrid(*grid, *voxelize::makeTransform(lattice_, {}), *comparison_->model,
                                                   comparison_->found));
        grids.insert(grids.begin(), grid);
        if (exporter::isNanoPath(job.path))
            exporter::writeNano(grids, job.path, o_.file);
        else
            exporter::writeVdb(grids, job.path, o_.file);
        writeUsda(grids, job);
    }

    void writeUsda(const openvdb::GridPtrVec& grids, const Job& job) const {
        if (o_.usda)
            exporter::writeUsda(
                grids, job.path, usdaOf(job.path),
                {0.001 * voxelize::millimetresIn(o_.unit), o_.up == "y", materialsOf(toolpath_, selection_)});
    }

    void tellOutput(const voxelize::Voxelizer& voxelizer, const Job& job, const GridNumbers& grid) {
        const auto bytes = isStandardOutput(job.path) ? 0 : fs::file_size(job.path);
        const exporter::GridStatistics& counted = grid.counted.statistics;
        files_.push_back({{"path", job.path.string()},
                          {"snapshot", job.label},
                          {"bytes", bytes},
                          {"beads", job.beads},
                          {"active_voxels", counted.active_voxels},
                          {"leaves_evaluated", voxelizer.report().leaves_evaluated},
                          {"leaves_reused", voxelizer.report().leaves_reused}});
        say(o_.common,
            fmt::format("  {}: {} active voxels, {} in memory, {} on disk", job.path.string(),
                        humanCount(static_cast<double>(counted.active_voxels)),
                        humanBytes(static_cast<double>(counted.memory_bytes)), humanBytes(static_cast<double>(bytes))));
    }

    void tellMesh(const exporter::SurfaceMesh& mesh, const openvdb::FloatGrid& grid) {
        files_.back()["mesh"] = describeMesh(mesh, grid, lattice_);
        say(o_.common, fmt::format("  {} triangles", humanCount(static_cast<double>(mesh.triangleCount()))));
    }

    // Reports that cost time: only of the whole print, and only if somebody reads them. `surface_mm3`: what the level
    // set of settled beads encloses, if that is asked for.
    void describeWhole(const voxelize::Voxelizer& voxelizer, const GridNumbers& grid, double surface_mm3) {
        const bool stats = !o_.common.stats.empty();
        if (settles() && (stats || o_.summary)) {
            const voxelize::DepositBalance balance = voxelizer.balance();
            if (o_.summary) say(o_.common, depositLines(balance));
            if (stats) deposit_ = describeDeposit(toolpath_.deposit, balance, surface_mm3);
        }
        if (stats) grid_ = describeGrid(grid, lattice_);
    }

    Json skipped(const voxelize::VoxelizeReport& built) const {
        Json skipped = Json::array();
        const auto skip = [&skipped](const char* what, const std::string& why, const std::string& saved) {
            skipped.push_back({{"what", what}, {"why", why}, {"saved", saved}});
        };
        if (selected_beads_ < toolpath_.beads.size()) {
            const std::string why = provenance_.selection.empty()
                                        ? "prime lines before layer 1 (--layers 0: keeps them)"
                                        : provenance_.selection;
            const std::string count =
                fmt::format("{} of {} beads", toolpath_.beads.size() - selected_beads_, toolpath_.beads.size());
            skip("beads", why, count);
            say(o_.common, fmt::format("  left out {}: {}", count, why));
        }
        if (!settles())
            skip("settling", "beads are capsules (--beads settled)", "pairs of neighbouring beads in each plan field");
        if (!flow_)
            skip("flow", "beads have their commanded widths (--flow-lag)", "a plan of the motion, and more beads");
        if (!comparison_)
            skip("the model", "no model to compare with (--compare)", "the outside as polygons, and their distances");
        if (!o_.interior_distance)
            skip("distances inside the solid", "the surface needs only their sign",
                 "a fast-sweeping pass over the grid");
        if (attributes_.empty())
            skip("attribute grids", "none asked for (--grids)",
                 "a nearest-bead search and four bytes a voxel for each");
        if (streams())
            skip("the grid in memory", "only its file is wanted", "a leaf of 2 kB for each that is in the file");
        if (!o_.report.asked())
            skip("the report", "not asked for (--report)", "floods and passes over a grid in memory");
        if (!o_.forecast && !culls())
            skip("what --interior cull would save", "not asked for (--forecast)",
                 "a flood through all leaves, about a third of a build");
        if (culls())
            skip("leaves that the outside can't reach", "--interior cull",
                 fmt::format("{} of {} leaf positions were never evaluated",
                             built.leaf_positions - built.leaves_evaluated, built.leaf_positions));
        return skipped;
    }

    Json report(const Json& left_out, int threads, double total) {
        Json toolpath_report = describeToolpath(toolpath_);
        toolpath_report["selected_bbox_mm"] = {bounds_.min, bounds_.max};
        return {{"input",
                 {{"path", input_},
                  {"bytes", file_.bytes().size()},
                  {"sha256", provenance_.source_sha256},
                  {"slicer", toolpath_.slicer},
                  {"format", toolpath_.format}}},
                {"toolpath", toolpath_report},
                {"time", times_ ? describeTimes(*times_, toolpath_.stated) : Json(nullptr)},
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

    const ConvertCommand& o_;
    const std::string& input_;
    const fs::path& output_;
    RunFiles& files_of_run_;
    std::optional<exporter::PartOfPrint> part_;  // if the output is one shard's
    Stopwatch total_, watch_;
    Seconds seconds_;
    const gcode::InputBytes file_;
    std::optional<motion::PrintTimes> times_;
    std::optional<deposit::FlowReport> flow_;
    std::optional<deposit::SagReport> sag_;
    gcode::Toolpath toolpath_;
    std::vector<std::uint32_t> selection_;
    std::size_t selected_beads_ = 0;
    voxelize::Bounds bounds_;
    bool as_mesh_ = false;
    voxelize::Interior interior_ = voxelize::Interior::keep;
    std::vector<voxelize::Attribute> attributes_;
    std::vector<std::optional<gcode::Rgb>> colors_;
    voxelize::Lattice lattice_;
    exporter::Provenance provenance_;
    voxelize::Placement placement_;
    std::optional<ProgressBar> bar_;
    Json files_ = Json::array();
    Json grid_, deposit_;
    std::optional<ModelComparison> comparison_;
};

}  // namespace

fs::path usdaOf(fs::path vdb) { return vdb.replace_extension(".usda"); }

Json convert(const ConvertCommand& command, const std::string& input, const fs::path& output, RunFiles& files_of_run,
             int threads) {
    // Unwritable places are found before the work, not after it.
    if (command.writesGrid()) const AtomicFile probe(output);
    std::optional<exporter::PartOfPrint> part;
    if (command.shard.shard) part = partOf(command, input);
    if (part && command.shard.resume && exporter::isPartOfPrint(output, part->version, part->scene, part->shard)) {
        say(command.common, fmt::format("  {}: is this shard of this scene already, skipped", output.string()));
        return {{"input", {{"path", input}}}, {"files", {{{"path", output.string()}, {"skipped", true}}}}};
    }
    return Conversion(command, input, output, files_of_run, std::move(part)).run(threads);
}

}  // namespace stratum::tools
