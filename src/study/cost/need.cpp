#include "study/study.h"

#include "deposit/printer.h"
#include "deposit/read_print.h"
#include "gcode/container/container.h"
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
#include "trace/scene_intersector.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColumns = "print,sha256,capability,run,read_cpu,convert_cpu,build_cpu,render_cpu,peak_rss_bytes";
constexpr std::array<const char*, 5> kMeasured{"read_cpu", "convert_cpu", "build_cpu", "render_cpu", "peak_rss_bytes"};

// What a run does beyond the least.
struct Setup {
    gcode::ReadOptions read;
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
        {"section", "--section 50%", [](Setup& s) { deposit::parseSection("50%", s.read.deposit); }},
        {"settled beads", "--beads settled",
         [](Setup& s) { s.read.deposit.beads = gcode::DepositModel::Beads::settled; }},
        {"flow", "--flow-lag 0.015 --pressure-advance 0",
         [](Setup& s) {
             s.read.deposit.flow_lag = 0.015;
             s.read.deposit.pressure_advance = 0;
         }},
        {"sag", "--sag 0.02", [](Setup& s) { s.read.deposit.sag = 0.02; }},
        {"typical printer", "--printer typical", [](Setup& s) { deposit::usePrinter("typical", s.read); }},
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

// In a process of its own: seconds to read, to convert, to build what rays need (material and light included), and to
// render.
Row measure(const std::string& print, const Setup& setup) {
    openvdb::initialize();
    const gcode::InputBytes file(print);
    gcode::Toolpath toolpath;
    const double read =
        timesOf([&] { toolpath = deposit::readPrint(file.bytes(), file.name(), setup.read, false).toolpath; }).cpu;
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
    return figures({read, convert, build, render, static_cast<double>(peakSoFar())});
}

// A sky that brightens upwards, with a lamp: 512 x 256 pixels.
void writeMap(const fs::path& path) {
    shade::Film film(512, 256, {0, 0, 512, 256});
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 512; ++x) {
            const bool lamp = std::abs(x - 128) < 16 && std::abs(y - 64) < 16;
            film.at(x, y) = {shade::Color(lamp ? 20.0f : static_cast<float>(256 - y) / 256.0f), 1.0f};
        }
    shade::PictureFile(path).write(film, {});
}

// What scripts/need_off.py has counted, if it has.
void addSwitchedOff(Page& page, const fs::path& csv, StudyReport& report) {
    std::ifstream file(csv);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(parseCsvLine(line));
    if (rows.size() < 2) return;
    constexpr const char* kOver = "over 1 %";
    page.heading("What it costs when it is off");
    page.paragraph(
        "The least conversion, the least picture of a level set and the least one straight from G-code, counted "
        "instruction by instruction (valgrind's callgrind, its total within main: the same figure every time, whatever "
        "else the machine does), beside what was counted before. A capability that is new and off must not add to it.");
    page.table(rows.front(), {rows.begin() + 1, rows.end()}, kOver);
    for (const Row& row : rows)
        if (row.back() == kOver)
            report.findings.push_back(fmt::format("{}: more instructions than before, {}", row.front(), kOver));
}

void addMedians(Page& page, const Table& table, const std::string& print, const std::vector<Capability>& all) {
    const auto values = [&](const char* capability, const char* column) {
        std::vector<double> found;
        for (const Row& row : table.rows())
            if (row[0] == print && row[2] == capability) found.push_back(table.number(row, column));
        return found;
    };
    std::vector<Row> rows;
    for (const Capability& one : all) {
        Row row{one.name, one.what};
        for (const char* column : kMeasured) {
            const double value = median(values(one.name, column));
            row.push_back(figure(value));
            row.push_back(fmt::format("{:+.1f}", (value / median(values(kNone, column)) - 1) * 100));
        }
        const std::vector<double> times = values(one.name, "render_cpu");
        const auto [low, high] = std::minmax_element(times.begin(), times.end());
        row.push_back(fmt::format("{:.3f} .. {:.3f}", *low, *high));
        rows.push_back(std::move(row));
    }
    page.heading(print);
    page.table({"capability", "how", "read CPU s", "%", "convert CPU s", "%", "build CPU s", "%", "render CPU s", "%",
                "peak bytes", "%", "least .. largest render CPU s"},
               rows);
}

}  // namespace

StudyReport studyNeed(const NeedOptions& options, const StudyOptions& common) {
    const int repeats = options.repeats > 0 ? options.repeats : common.quick ? 3 : 7;
    Table table(kColumns);
    const fs::path map = common.folder / fmt::format(".need-{}.exr", ::getpid());
    // In a process of its own: writing starts threads, which would not survive the forks to come.
    rowInOwnProcess(map.string(), 1, [&] {
        writeMap(map);
        return Row{};
    });
    const std::vector<Capability> all = capabilities(map.string());
    double done = 0;
    const double steps = static_cast<double>(options.prints.size()) * repeats * static_cast<double>(all.size());
    for (const std::string& print : options.prints)
        for (int run = 1; run <= repeats; ++run)
            for (const Capability& one : all) {
                Setup setup = leastSetup(common.quick);
                one.add(setup);
                const Row key{fs::path(print).filename().string(), shortHash(print), one.name, std::to_string(run)};
                table.add(joined(key, rowInOwnProcess(fmt::format("{}: {}", print, one.name), common.threads,
                                                      [&] { return measure(print, setup); })));
                if (common.progress) common.progress(++done / steps);
            }
    fs::remove(map);
    Page page("What each capability costs", common.command);
    page.paragraph(fmt::format(
        "Each print is converted at two voxels a layer and rendered with 16 samples a pixel: with the least there is, "
        "and with one capability more. Medians of {} runs, each a process of its own, taking turns; percentages are of "
        "the least. Seconds are CPU time of all threads. \"{}\" is the least measured twice: what it shows is the "
        "noise of this machine.",
        repeats, kNoneAgain));
    StudyReport report;
    for (const std::string& print : options.prints) addMedians(page, table, fs::path(print).filename().string(), all);
    addSwitchedOff(page, common.folder / "need_off.csv", report);
    writeTable(common, "need", table, report);
    writePage(common, "need", page, report);
    return report;
}

}  // namespace stratum::study
