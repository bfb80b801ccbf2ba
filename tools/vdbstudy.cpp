// vdbstudy: what the other two tools cost and how exact they are, measured on this machine.
#include "choices.h"
#include "command_line.h"
#include "manual.h"
#include "output_names.h"
#include "progress.h"
#include "run_files.h"

#include "base/human_text.h"
#include "study/polygons/peer_tracers.h"
#include "study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace stratum;

constexpr const char* kExamples = R"(
Each study writes its tables, NAME.csv, and NAME.html, one page that holds all
it shows.

Examples:
  vdbstudy memory part.gcode -o studies       bytes against voxel size
  vdbstudy memory *.gcode -o studies --voxels-per-layer 1,2,3,4,6
  vdbstudy geometry part.gcode -o studies --layers 1:20
  vdbstudy stability -o studies               cases that could go wrong
  vdbstudy render part.gcode -o studies       error of pictures against time
  vdbstudy need part.gcode -o studies         what is not needed, and its cost
  vdbstudy deposit part.gcode -o studies      volume, roughness, corners, times
  vdbstudy polygons --scenes data/scenes/*.json -o studies
  vdbstudy polygons prints/ -o studies        level sets beside beads)";

struct Options {
    tools::CommonOptions common;
    study::StudyOptions study;
    study::MemoryOptions memory;
    study::GeometryOptions geometry;
    study::NeedOptions need;
    study::RenderStudyOptions render;
    study::PolygonsOptions polygons;
    study::DepositOptions deposit;
};

// A verb, and the study that it asks for.
struct Verb {
    CLI::App* app;
    std::function<study::StudyReport()> work;
};

// A list of numbers, with commas between, from `least` to `most`.
template <typename Number>
void addList(CLI::App* verb, const char* name, std::vector<Number>& values, const char* help, Number least,
             Number most) {
    verb->add_option(name, values, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(least, most))
        ->type_name("N,...");
}

void addCount(CLI::App* verb, const char* name, auto& value, const char* help, int most = 1000) {
    verb->add_option(name, value, help)->check(CLI::Range(1, most))->type_name("N");
}

// What every study takes.
CLI::App* addVerb(CLI::App& app, Options& o, const char* name, const char* help) {
    CLI::App* verb = app.add_subcommand(name, help);
    verb->add_option("-o,--output", o.study.folder, "Folder for the table and the page; made if missing")
        ->required()
        ->type_name("DIR");
    verb->add_flag("--quick", o.study.quick, "Less of everything: a look, not a measurement");
    tools::addCommonOptions(*verb, o.common);
    return verb;
}

void addDeposit(CLI::App& app, Options& o, std::vector<Verb>& verbs) {
    CLI::App* deposit = addVerb(app, o, "deposit", "The plastic: volume, roughness, corners, times");
    deposit->add_option("PRINT", o.deposit.prints, "Prints, for volume and times")->required()->type_name("FILE.gcode");
    deposit->add_option("--times", o.deposit.timed, "More prints, for their times alone; may be given again")
        ->type_name("FILE");
    deposit->add_option("--layers", o.deposit.layers, "Of the volumes (default 1:20)")->type_name("A:B");
    verbs.push_back({deposit, [&o] { return study::studyDeposit(o.deposit, o.study); }});
}

std::vector<Verb> addVerbs(CLI::App& app, Options& o) {
    std::vector<Verb> verbs;
    CLI::App* memory = addVerb(app, o, "memory", "Bytes against voxel size, in memory and on disk");
    memory->add_option("PRINT", o.memory.prints, "Prints to convert")->required()->type_name("FILE.gcode");
    addList(memory, "--voxels-per-layer", o.memory.voxels_per_layer, "Sizes (default 1,2,3,4)", 1, 64);
    verbs.push_back({memory, [&o] { return study::studyMemory(o.memory, o.study); }});
    CLI::App* geometry = addVerb(app, o, "geometry", "From the beads' exact surface to the level set");
    geometry->add_option("PRINT", o.geometry.print, "A print; its level beads count")
        ->required()
        ->type_name("FILE.gcode");
    geometry->add_option("--layers", o.geometry.layers, "Only these layers")->type_name("A:B");
    addList(geometry, "--voxels-per-layer", o.geometry.counts, "Sizes (default 1,2,3,4,6,8)", 0.5, 64.0);
    addCount(geometry, "--points", o.geometry.points, "On the surface (default 40000)", 100000000);
    verbs.push_back({geometry, [&o] { return study::studyGeometry(o.geometry, o.study); }});
    CLI::App* render = addVerb(app, o, "render", "Error of pictures against run time");
    render->add_option("PRINT", o.render.print, "A print")->required()->type_name("FILE.gcode");
    addList(render, "--voxels-per-layer", o.render.per_layer, "Sizes (default 1,2,4,8)", 1, 64);
    addCount(render, "--seeds", o.render.seeds, "Pictures of each kind (default 5)");
    verbs.push_back({render, [&o] { return study::studyRender(o.render, o.study); }});
    CLI::App* stability = addVerb(app, o, "stability", "Stiff and extreme cases, each with a verdict");
    verbs.push_back({stability, [&o] { return study::studyStability(o.study); }});
    CLI::App* need = addVerb(app, o, "need", "What a scene does not use, and its cost");
    need->add_option("PRINT", o.need.prints, "Prints to convert and render")->required()->type_name("FILE.gcode");
    addCount(need, "--repeats", o.need.repeats, "Runs of each (default 7)");
    verbs.push_back({need, [&o] { return study::studyNeed(o.need, o.study); }});
    addDeposit(app, o, verbs);
    CLI::App* polygons = addVerb(app, o, "polygons", "Level sets and formulas beside polygons and beads");
    polygons->add_option("PRINT", o.polygons.prints, "Prints, or folders of them; *.json are scenes")
        ->type_name("FILE.gcode|DIR|SCENE.json");
    polygons
        ->add_option("--scenes", o.polygons.scenes,
                     "A scene of spheres, boxes and cylinders; may be given again for more")
        ->allow_extra_args(false)
        ->type_name("SCENE.json");
    polygons->add_option("--env", o.polygons.environment, "Light of the prints, as vdbtrace takes it (default studio)")
        ->type_name("SPEC|FILE");
    polygons->add_option("--integrators", o.polygons.integrators, "Of the prints: path, ao (default both)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(tools::oneOf({"path", "ao"}))
        ->type_name("NAME,...");
    addCount(polygons, "--spp", o.polygons.spp, "Samples a pixel of the path-traced prints (default 32)", 65536);
    addCount(polygons, "--frames", o.polygons.frames, "Of each scene (default 10)");
    verbs.push_back({polygons, [&o] { return study::studyPolygons(o.polygons, study::peerTracers(), o.study); }});
    return verbs;
}

void run(const Verb& verb, Options& o, int argc, char** argv) {
    Stopwatch watch;
    o.study.command.assign(argv, argv + argc);
    o.study.threads = o.common.threads;
    // A shell puts all names of a pattern after --scenes, of which the first is its own.
    std::vector<std::string>& prints = o.polygons.prints;
    const auto scenes = std::stable_partition(prints.begin(), prints.end(),
                                              [](const std::string& name) { return !name.ends_with(".json"); });
    o.polygons.scenes.insert(o.polygons.scenes.end(), scenes, prints.end());
    prints.erase(scenes, prints.end());
    tools::RunFiles files;
    for (const auto* inputs : {&o.memory.prints, &o.need.prints, &o.polygons.prints, &o.deposit.prints,
                               &o.deposit.timed, &o.polygons.scenes})
        for (const auto& print : *inputs) files.reads(print);
    for (const auto& print : {o.geometry.print, o.render.print}) files.reads(print);
    const std::string name = (o.study.folder / verb.app->get_name()).string();
    for (const char* ending :
         {".csv", "_scenes.csv", "_prints.csv", "_volume.csv", "_roughness.csv", "_corner.csv", "_time.csv"})
        files.writes(name + ending, "-o");
    files.writes(name + ".html", "-o");
    files.writesBeside(o.common.stats, "--stats");
    tools::makeFolder(o.study.folder);
    tools::ProgressBar bar(verb.app->get_name(), o.common.quiet);
    o.study.progress = bar.callback();
    const study::StudyReport report = verb.work();
    for (const std::string& finding : report.findings)
        if (!o.common.quiet) tools::tellError(fmt::format("vdbstudy: {}\n", finding));
    const double seconds = watch.lap();
    tools::say(o.common, fmt::format("{}: {}, {}, {:.1f} s", verb.app->get_name(), counted(report.rows, "row"),
                                     counted(report.findings.size(), "finding"), seconds));
    tools::say(o.common, fmt::format("  {}\n  {}", report.csv.string(), report.html.string()));
    tools::writeStats(o.common, {{"study", verb.app->get_name()},
                                 {"rows", report.rows},
                                 {"findings", report.findings},
                                 {"csv", report.csv.string()},
                                 {"html", report.html.string()},
                                 {"seconds", seconds}});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures what prints cost as level sets and pictures, and how exact both are.", "vdbstudy");
    Options options;
    const std::vector<Verb> verbs = addVerbs(app, options);
    app.require_subcommand(1);
    tools::addVersion(app);
    tools::addManual(app);
    app.footer(kExamples);
    return tools::runTool(app, argc, argv, [&] {
        for (const Verb& verb : verbs)
            if (verb.app->parsed()) run(verb, options, argc, argv);
    });
}
