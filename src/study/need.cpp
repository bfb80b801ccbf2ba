#include "study/need.h"

#include "io/error.h"
#include "march/brick_intersector.h"
#include "shade/render.h"
#include "shade/scene.h"
#include "study/own_process.h"
#include "study/page.h"
#include "study/print.h"
#include "study/result_table.h"
#include "study/times.h"
#include "voxelize/interior_distance.h"
#include "voxelize/selection.h"
#include "voxelize/voxelizer.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print",           "sha256",        "capability",     "run",
                   "convert_seconds", "build_seconds", "render_seconds", "peak_rss_bytes"};
constexpr std::size_t kKeys = 4;
constexpr std::size_t kConvert = 4, kBuild = 5, kRender = 6, kPeak = 7;

// What a run does beyond the least.
struct Setup {
    std::vector<voxelize::Attribute> attributes;
    bool interior_distance = false;
    shade::SceneOptions scene;
    shade::RenderOptions render;
};

struct Capability {
    const char* name;
    const char* what;
    std::function<void(Setup&)> add;
};

constexpr const char* kNone = "none";
constexpr const char* kNoneAgain = "none, once more";

std::vector<Capability> capabilities() {
    using shade::Aov;
    return {
        {kNone, "a matt print in even light", [](Setup&) {}},
        {kNoneAgain, "the same: what differs is noise", [](Setup&) {}},
        {"attribute grids", "--grids layer,width",
         [](Setup& s) {
             s.attributes = {voxelize::Attribute::layer, voxelize::Attribute::width};
         }},
        {"distances inside", "--interior-distance", [](Setup& s) { s.interior_distance = true; }},
        {"measured material", "--brdf pla-blue", [](Setup& s) { s.scene.brdf = "pla-blue"; }},
        {"studio light", "--env studio", [](Setup& s) { s.scene.env = "studio"; }},
        {"sky", "--env sky", [](Setup& s) { s.scene.env = "sky"; }},
        {"bed", "--bed", [](Setup& s) { s.scene.bed = true; }},
        {"layer of normals", "--aov normal", [](Setup& s) { s.render.aovs = {Aov::normal}; }},
        {"layers of everything", "--aov normal,depth,position,albedo,mask",
         [](Setup& s) {
             s.render.aovs = {Aov::normal, Aov::depth, Aov::position, Aov::albedo, Aov::mask};
         }},
        {"adaptive statistics", "--noise, too small to be reached before --spp",
         [](Setup& s) { s.render.noise = 1e-6; }},
    };
}

Setup leastSetup(bool quick) {
    Setup setup;
    setup.scene.brdf = "lambert:0.5,0.5,0.5";
    setup.scene.env = "constant:1,1,1";
    setup.scene.bed = false;
    setup.render.width = quick ? 160 : 320;
    setup.render.height = quick ? 120 : 240;
    setup.render.spp = 16;
    return setup;
}

// In the child: seconds to convert, to build what rays need (material and light included), and to render.
std::string measure(const std::string& print, const Setup& setup, int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
    openvdb::initialize();
    const gcode::Toolpath toolpath = readPrint(print);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, 2);
    openvdb::FloatGrid::Ptr grid;
    std::vector<openvdb::GridBase::Ptr> attributes;
    const double convert = timesOf([&] {
                               voxelize::Voxelizer voxelizer(toolpath, beads, lattice);
                               grid = voxelizer.printAll();
                               attributes = voxelizer.attributes(setup.attributes);
                               if (setup.interior_distance) voxelize::sweepInterior(*grid);
                           }).wall;
    std::unique_ptr<march::Intersector> intersector;
    std::optional<shade::SceneDescription> scene;
    const double build = timesOf([&] {
                             intersector = march::makeBrickIntersector(*grid);
                             scene =
                                 shade::makeScene(setup.scene, *intersector, setup.render.width, setup.render.height);
                         }).wall;
    const double render = timesOf([&] { shade::render(*intersector, *scene, setup.render); }).wall;
    return fmt::format("{:.5f},{:.5f},{:.5f}", convert, build, render);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::string percent(double with, double without) { return fmt::format("{:+.1f}", (with / without - 1) * 100); }

}  // namespace

StudyReport studyNeed(const NeedOptions& options, const StudyOptions& common) {
    const int repeats = options.repeats > 0 ? options.repeats : common.quick ? 3 : 7;
    ResultTable table(common.folder / "need.csv", kColumns, kKeys, common.fresh);
    const std::vector<Capability> all = capabilities();
    Page page("What each capability costs", common.command);
    page.paragraph(fmt::format(
        "Each print is converted at two voxels a layer and rendered with 16 samples a pixel: with the least there is, "
        "and "
        "with one capability more. Medians of {} runs, each a process of its own, taking turns; percentages are of the "
        "least. \"{}\" is the least measured twice: what it shows is the noise of this machine.",
        repeats, kNoneAgain));
    StudyReport report;
    double done = 0;
    const double steps = static_cast<double>(options.prints.size()) * repeats * static_cast<double>(all.size());
    for (const std::string& print : options.prints) {
        const std::string name = fs::path(print).filename().string();
        const std::string hash = shortHash(print);
        std::vector<std::vector<double>> columns(all.size() * 4);
        for (int run = 0; run < repeats; ++run)
            for (std::size_t n = 0; n < all.size(); ++n) {
                const Row key{name, hash, all[n].name, std::to_string(run + 1)};
                if (table.find(key) == nullptr) {
                    Setup setup = leastSetup(common.quick);
                    all[n].add(setup);
                    const Outcome outcome = inOwnProcess([&] { return measure(print, setup, common.threads); });
                    if (!outcome.failure.empty())
                        throw InputError(fmt::format("{}: {}: {}", print, all[n].name, outcome.failure));
                    Row row = key;
                    const Row seconds = parseCsvLine(outcome.text);
                    row.insert(row.end(), seconds.begin(), seconds.end());
                    row.push_back(std::to_string(outcome.peak_rss_bytes));
                    table.add(std::move(row));
                }
                const Row& row = *table.find(key);
                for (std::size_t c = 0; c < 4; ++c) columns[4 * n + c].push_back(std::atof(row[kConvert + c].c_str()));
                if (common.progress) common.progress(++done / steps);
            }
        const auto at = [&](std::size_t n, std::size_t column) { return median(columns[4 * n + column - kConvert]); };
        std::vector<Row> rows;
        for (std::size_t n = 0; n < all.size(); ++n) {
            Row row{all[n].name, all[n].what};
            for (const std::size_t column : {kConvert, kBuild, kRender}) {
                row.push_back(fmt::format("{:.3f}", at(n, column)));
                row.push_back(percent(at(n, column), at(0, column)));
            }
            row.push_back(fmt::format("{:.1f}", at(n, kPeak) * 1e-6));
            row.push_back(percent(at(n, kPeak), at(0, kPeak)));
            rows.push_back(std::move(row));
        }
        page.heading(name);
        page.table({"capability", "how", "convert s", "%", "build s", "%", "render s", "%", "peak MB", "%"}, rows);
    }
    report.csv = table.path();
    report.html = common.folder / "need.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    page.write(report.html);
    return report;
}

}  // namespace stratum::study
