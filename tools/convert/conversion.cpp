#include "convert/conversion.h"

#include "convert/conversion_steps.h"
#include "convert/elements_output.h"
#include "convert/mesh_output.h"
#include "convert/reports.h"
#include "print_options.h"

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/human_text.h"
#include "deposit/read_print.h"
#include "export/mesh_file.h"
#include "export/nano_file.h"
#include "gcode/summary.h"
#include "gcode/toolpath/toolpath_csv.h"
#include "gcode/toolpath/warning_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Whether anything asks when beads are laid.
bool needsTimes(const ConvertCommand& o) {
    const std::vector<voxelize::Attribute> grids = voxelize::parseGrids(o.grids);
    return o.summary || o.report.asked() || !o.common.stats.empty() || voxelize::needsTiming(o.snapshots) ||
           std::any_of(grids.begin(), grids.end(), voxelize::usesTiming);
}

exporter::LevelSetChoices choicesOf(const ConvertCommand& o, const fs::path& output) {
    exporter::LevelSetChoices choices;
    choices.print = o.print;
    const bool as_mesh = exporter::isMeshPath(output);
    if (o.interior == "cull" || (o.interior.empty() && as_mesh)) choices.interior = voxelize::Interior::cull;
    choices.interior_distance = o.interior_distance;
    // Who chooses features chooses from all of them.
    choices.part_alone = as_mesh && o.print.features.empty();
    // Meshes choose by their format, and elements have none.
    if (as_mesh || isElementsPath(output))
        choices.attributes.emplace();
    else if (!o.grids.empty())
        choices.attributes = voxelize::parseGrids(o.grids);
    if (as_mesh)
        choices.output = exporter::Output::mesh;
    else if (exporter::isNanoPath(output))
        choices.output = exporter::Output::nano;
    choices.unit = o.unit;
    choices.up = o.up;
    choices.origin = o.origin;
    return choices;
}

}  // namespace

Conversion::Conversion(const ConvertCommand& command, const std::string& input, const fs::path& output,
                       RunFiles& files_of_run)
    : o_(command), input_(input), output_(output), files_of_run_(files_of_run), file_(input) {}

Json Conversion::run(int threads) {
    read();
    tell();
    const bool needs_beads = settles() || stats() || !o_.compare.model.empty();
    if (!o_.makesGrid() && !needs_beads) return finish(Json(), threads);
    choose();
    if (isElementsPath(output_)) {
        makeElements();
        const Json left_out{{{"what", "the level set"},
                             {"why", "elements need its signs alone"},
                             {"saved", "leaves, their grid and file"}}};
        return finish(left_out, threads);
    }
    sha256_ = sha256Hex(file_.bytes());
    voxelize::Voxelizer voxelizer(toolpath_, plan_->selection(), plan_->lattice(), voxelizeOptions());
    seconds_.voxelize += watch_.lap();
    if (!o_.compare.model.empty()) comparison_ = compareWithModel(o_, toolpath_, plan_->selection(), plan_->lattice());
    seconds_.compare = watch_.lap();
    if (!o_.makesGrid()) {
        tellDeposit(voxelizer, 0);
        const Json left_out{{{"what", "the level set"},
                             {"why", "a summary and a comparison need none (-o FILE writes it)"},
                             {"saved", "leaves, their grid and file"}}};
        return finish(left_out, threads);
    }
    const std::vector<ConversionJob> jobs = planJobs();
    for (const ConversionJob& job : jobs)
        if (!job.label.empty()) {
            noteOutput(o_, job.path, "--snapshots", files_of_run_);
            if (o_.usda) files_of_run_.writes(usdaOf(job.path).string(), "--usda");
        }
    for (const ConversionJob& job : jobs) make(voxelizer, job);
    return finish(stats() ? skipped(voxelizer.report()) : Json(), threads);
}

Json Conversion::finish(const Json& left_out, int threads) {
    const double total = total_.lap();
    say(o_.common, fmt::format("  done in {:.2f} s", total));
    return stats() ? report(left_out, threads, total) : Json();
}

bool Conversion::streams() const {
    return plan_->streams() && !as_mesh_ && !exporter::isNanoPath(output_) && !o_.compare.grid &&
           o_.snapshots.empty() && !o_.forecast && !o_.report.asked() && !(settles() && stats());
}

void Conversion::warn(const std::string& text) const {
    if (!o_.common.quiet) tellError(fmt::format("gcode2vdb: {}\n", text));
}

void Conversion::read() {
    gcode::ReadOptions read = o_.print.read;
    ProgressBar bar("reading", o_.common.quiet);
    read.progress = bar.callback();
    deposit::PrintRead print = deposit::readPrint(file_.bytes(), file_.name(), read, needsTimes(o_));
    toolpath_ = std::move(print.toolpath);
    times_ = std::move(print.times);
    if (times_ && (o_.summary || stats()))
        estimate_ = motion::estimatedTimes(file_.bytes(), file_.name(), read, *times_, toolpath_);
    flow_ = print.flow;
    sag_ = print.sag;
    seconds_.parse = watch_.lap();
}

void Conversion::tell() const {
    // A summary has them, too.
    if (!o_.summary)
        for (const gcode::Warning& warning : toolpath_.warnings) warn(gcode::describe(warning, file_.name()));
    if (!o_.dump_toolpath.empty()) gcode::writeToolpathCsv(toolpath_, o_.dump_toolpath);
    if (o_.common.quiet) return;
    say(o_.common, fmt::format("{}: {}, {}, {} ({}), {:.2f} m of filament, {:.2f} cm3", file_.name(),
                               toolpath_.slicer.empty() ? "unknown slicer" : toolpath_.slicer,
                               counted(toolpath_.layer_count, "layer"), counted(toolpath_.beads.size(), "bead"),
                               counted(toolpath_.arcs.size(), "arc"), toolpath_.filament_mm * 1e-3,
                               gcode::beadVolume(toolpath_) * 1e-3));
    if (o_.summary) say(o_.common, gcode::summarize(toolpath_) + timeLines(*times_, estimate_, toolpath_.stated));
    if (o_.summary && flow_) say(o_.common, flowLine(*flow_));
    if (o_.summary && sag_) say(o_.common, sagLine(*sag_));
}

// Beads, grids and the lattice.
void Conversion::choose() {
    as_mesh_ = exporter::isMeshPath(output_);
    plan_.emplace(toolpath_, choicesOf(o_, output_));
    attributes_ = as_mesh_ ? meshAttributes(o_, toolpath_, plan_->selection(), output_) : plan_->attributes();
    if (plan_->leftOut() > 0)
        say(o_.common,
            fmt::format("  without what is printed beside the part: {} beads of skirts, prime lines and towers "
                        "(--features all keeps them)",
                        plan_->leftOut()));
    if (plan_->addsColor() && o_.makesGrid())
        say(o_.common,
            fmt::format("  {} colors of filament: a color grid, too (--grids surface: none)", plan_->colors()));
    const voxelize::Lattice& lattice = plan_->lattice();
    if (!o_.makesGrid()) return;
    say(o_.common, fmt::format("  voxel {:g} mm ({}); {:.0f} % of the length lies on voxel planes", lattice.voxel_size,
                               lattice.reason, lattice.aligned_share * 100));
    // Elements are chosen for what a solver can take, not for layer lines; they say what volume they hold.
    if (!lattice.warning.empty() && !isElementsPath(output_))
        warn(fmt::format("{}: {}", file_.name(), lattice.warning));
}

std::vector<ConversionJob> Conversion::planJobs() const {
    const std::vector<std::uint32_t>& selection = plan_->selection();
    std::vector<ConversionJob> jobs;
    if (!o_.snapshots.empty()) {
        for (const voxelize::Snapshot& snapshot : voxelize::parseSnapshots(o_.snapshots, toolpath_)) {
            fs::path path = output_;
            path.replace_filename(
                fmt::format("{}_{}{}", output_.stem().string(), snapshot.label, output_.extension().string()));
            const auto end = static_cast<std::uint32_t>(snapshot.bead_count);
            const auto beads = std::lower_bound(selection.begin(), selection.end(), end) - selection.begin();
            if (beads > 0)
                jobs.push_back({snapshot.label, path, static_cast<std::size_t>(beads), end});
            else
                say(o_.common, fmt::format("  no {}: nothing is printed by then", path.string()));
        }
    }
    jobs.push_back({"", output_, selection.size(), static_cast<std::uint32_t>(toolpath_.beads.size())});
    return jobs;
}

voxelize::VoxelizeOptions Conversion::voxelizeOptions() {
    voxelize::VoxelizeOptions options = plan_->voxelizeOptions();
    if (streams()) options.bytes_per_leaf = 0;
    if (showsProgress(o_.common.quiet))
        options.progress = [this](double fraction) {
            if (bar_) bar_->show(fraction);
        };
    return options;
}

fs::path usdaOf(fs::path vdb) { return vdb.replace_extension(".usda"); }

Json convert(const ConvertCommand& command, const std::string& input, const fs::path& output, RunFiles& files_of_run,
             int threads) {
    // Unwritable places are found before the work, not after it.
    if (command.writesGrid()) AtomicFile::probe(output);
    return Conversion(command, input, output, files_of_run).run(threads);
}

}  // namespace stratum::tools
