#include "study/cost/need.h"

#include "base/error.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "shade/film/picture.h"
#include "shade/integrator/render.h"
#include "shade/post/denoise.h"
#include "shade/scene/scene.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "study/report/page.h"
#include "study/report/result_table.h"
#include "trace/scene_intersector.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print", "sha256", "capability", "run", "convert_cpu", "build_cpu", "render_cpu", "peak_rss_bytes"};
constexpr std::size_t kKeys = 4;
constexpr std::size_t kConvert = 4, kBuild = 5, kRender = 6, kPeak = 7;

// What a run does beyond the least.
struct Setup {
    std::vector<voxelize::Attribute> attributes;
    bool interior_distance = false;
    bool second_object = false;  // the print once more, where no ray goes
    bool denoise = false;
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

// `map`: a file with the light of an environment.
std::vector<Capability> capabilities(const std::string& map) {
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
        {"map of light", "--env FILE.exr, 512 x 256", [map](Setup& s) { s.scene.env = map; }},
        {"smooth normals", "--normals smooth", [](Setup& s) { s.scene.smooth_normals = true; }},
        {"second object", "a scene of two objects, one out of sight", [](Setup& s) { s.second_object = true; }},
        {"lens", "--f-number 8", [](Setup& s) { s.scene.camera.f_number = 8; }},
        {"denoiser", "--denoise", [](Setup& s) { s.denoise = true; }},
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
                           }).cpu;
    std::shared_ptr<const trace::Intersector> intersector;
    std::optional<shade::SceneDescription> scene;
    const double build = timesOf([&] {
                             intersector = march::makeBrickIntersector(*grid);
                             march::Annotation annotation;
                             if (setup.scene.smooth_normals) annotation.smooth = grid;
                             intersector = march::annotate(std::move(intersector), std::move(annotation));
                             scene =
                                 shade::makeScene(setup.scene, *intersector, setup.render.width, setup.render.height);
                         }).cpu;
    if (setup.second_object)
        intersector = trace::makeSceneIntersector(
            {{intersector, {}}, {intersector, trace::Placement::of({1, 1, 1}, {0, 0, 0}, {1e4, 0, 0})}});
    shade::RenderOptions options = setup.render;
    if (setup.denoise) shade::addDenoisingGuides(options);
    const double render = timesOf([&] {
                              shade::RenderResult result = shade::render(*intersector, *scene, options);
                              if (setup.denoise) shade::denoise(result.film);
                          }).cpu;
    return fmt::format("{:.5f},{:.5f},{:.5f}", convert, build, render);
}

// A sky that brightens upwards, with a lamp: 512 x 256 pixels.
std::string writeMap(const fs::path& folder) {
    fs::create_directories(folder);
    const fs::path path = folder / "need_map.exr";
    shade::Film film(512, 256, {0, 0, 512, 256});
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 512; ++x) {
            const bool lamp = std::abs(x - 128) < 16 && std::abs(y - 64) < 16;
            film.at(x, y) = {shade::Color(lamp ? 20.0f : static_cast<float>(256 - y) / 256.0f), 1.0f};
        }
    shade::PictureFile(path).write(film, {});
    return path.string();
}

// What scripts/need_off.py has counted, if it has.
void addSwitchedOff(Page& page, const fs::path& csv, StudyReport& report) {
    static const Row kOffColumns{"work", "capability", "functions", "instructions", "percent", "run"};
    constexpr std::size_t kWork = 0, kName = 1, kShare = 4;
    std::ifstream file(csv);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(parseCsvLine(line));
    if (rows.size() < 2) return;
    if (rows.front() != kOffColumns) {
        report.findings.push_back(fmt::format("{}: of an older version; run scripts/need_off.py", csv.string()));
        return;
    }
    constexpr double kMost = 1;  // %
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (std::size_t n = 1; n < rows.size(); ++n) {
        Row row = rows[n];
        const bool over = numberIn(row, kShare) > kMost;
        if (over)
            report.findings.push_back(
                fmt::format("{}: {} costs {} % when it is off", row[kWork], row[kName], row[kShare]));
        row.insert(row.end() - 1, over ? "over 1 %" : "ok");
        cells.push_back(std::move(row));
        lines.push_back(n + 1);
    }
    page.heading("What it costs when it is off");
    page.paragraph(
        "The least conversion, the least picture of a level set and the least one straight from G-code, counted "
        "instruction by instruction (valgrind's callgrind: the same figure every time, whatever else the machine "
        "does): how many of the program's own instructions are spent in the functions of each capability while it is "
        "off, with what they call. Functions that the compiler has merged into their callers, a test of a flag mostly, "
        "can't be told apart. What a program has no function of (the viewer) has none.");
    page.table({"work", "capability", "functions", "instructions", "% of all", "verdict", "run"}, cells, "over 1 %",
               lines, "need_off");
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::string percent(double with, double without) { return fmt::format("{:+.1f}", (with / without - 1) * 100); }

}  // namespace

StudyReport studyNeed(const NeedOptions& options, const StudyOptions& common) {
    const int repeats = options.repeats > 0 ? options.repeats : common.quick ? 3 : 7;
    ResultTable table(common, "need.csv", kColumns, kKeys);
    // In a process of its own: writing starts threads, which would not survive the forks to come.
    const Outcome map = inOwnProcess([&] { return writeMap(common.folder / "references"); });
    if (!map.failure.empty()) throw OutputError(map.failure);
    const std::vector<Capability> all = capabilities(map.text);
    Page page("What each capability costs", common.command);
    page.paragraph(fmt::format(
        "Each print is converted at two voxels a layer and rendered with 16 samples a pixel: with the least there is, "
        "and "
        "with one capability more. Medians of {} runs, each a process of its own, taking turns; percentages are of the "
        "least. Seconds are CPU time of all threads. \"{}\" is the least measured twice: what it shows is the noise of "
        "this machine.",
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
        std::vector<std::size_t> lines;
        for (std::size_t n = 0; n < all.size(); ++n) {
            Row row{all[n].name, all[n].what};
            for (const std::size_t column : {kConvert, kBuild, kRender}) {
                row.push_back(fmt::format("{:.3f}", at(n, column)));
                row.push_back(percent(at(n, column), at(0, column)));
            }
            row.push_back(fmt::format("{:.1f}", at(n, kPeak) * 1e-6));
            row.push_back(percent(at(n, kPeak), at(0, kPeak)));
            const std::vector<double>& times = columns[4 * n + kRender - kConvert];
            const auto [low, high] = std::minmax_element(times.begin(), times.end());
            row.push_back(fmt::format("{:.3f} .. {:.3f}", *low, *high));
            const Row first{name, hash, all[n].name, "1"};
            row.push_back(table.find(first)->back());
            lines.push_back(table.lineOf(first));
            rows.push_back(std::move(row));
        }
        page.heading(name);
        page.table({"capability", "how", "convert CPU s", "%", "build CPU s", "%", "render CPU s", "%", "peak MB", "%",
                    "least .. largest render CPU s", "run"},
                   rows, {}, lines, "need");
    }
    addSwitchedOff(page, common.folder / "need_off.csv", report);
    page.runs(table);
    report.csv = table.path();
    report.html = common.folder / "need.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    page.write(report.html);
    return report;
}

}  // namespace stratum::study
