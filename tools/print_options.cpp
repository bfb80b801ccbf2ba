#include "print_options.h"

#include "choices.h"

#include "assemble/print/read_print_options.h"
#include "base/error.h"
#include "gcode/option_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace stratum::tools {

namespace {

// The headings of options that are of prints alone.
constexpr const char* kLattice = "Lattice";
constexpr const char* kWhat = "What to convert";
constexpr const char* kReading = "Reading";
constexpr const char* kPlastic = "Plastic";

void addLatticeOptions(CLI::App& app, bool pictures) {
    const Declarations lattice(app, kLattice);
    lattice("--voxel-size", pictures ? "MM|auto" : "MM",
            pictures ? "Edge of a voxel; auto: half of what a pixel spans where the print is nearest to the camera"
                     : "Edge of a voxel");
    lattice("--voxels-per-layer", "N", "Voxels in a layer height (1 to 64)");
    lattice("--tolerance", "MM", "Coarsest voxel whose surface stays this near to the beads");
    lattice("--memory-budget", "SIZE", "Finest voxel that fits, e.g. 4GB or 4GiB");
    lattice("--half-width", "VOXELS", "Narrow band to each side (default 3)");
}

void addSelectionOptions(CLI::App& app) {
    const Declarations what(app, kWhat);
    what("--layers", "A:B", "Only layers A to B, counted from 1; 0 is prime lines (default 1:)");
    std::vector<std::string> features;
    for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
        features.emplace_back(gcode::featureName(static_cast<gcode::Feature>(f)));
    completes(what("--features", "LIST",
                   "Only (+NAME,...) or all but (-NAME,...) these features; all: also what meshes leave out"),
              Completion::selection, features);
    what.several("--object", "NAME|NUMBER", "Only this object of the print; may be given again for more");
    what.several("--tool", "N,...", "Only what these tools (T numbers) print; may be given again for more");
}

void addPlasticOptions(CLI::App& app) {
    const Declarations plastic(app, kPlastic);
    completes(
        plastic("--printer", "PRESET|FILE",
                "What the printer makes of the program: ideal: beads as commanded (default); typical: a model of "
                "a tuned printer, all effects below; or a file: its limits, for true times, from Klipper's "
                "printer.cfg, RepRapFirmware's config.g or a report of Marlin's M503, or all of it as JSON. Other "
                "options override it"),
        Completion::preset, {"ideal", "typical"});
    plastic("--flow", "PERCENT",
            "Extrusion in per cent of what the file says, as a knob on the printer or M221 (default 100)");
    completes(
        plastic("--beads", "MODEL",
                "What overlapping beads do: capsule: nothing, they are united (default); settled: what two "
                "neighbours both claim fills the groove between them, and what has no room there presses outlines "
                "out and raises tops; grooves: only the first of both"),
        Completion::word, wordsOf(gcode::kBeadModels));
    completes(plastic("--section", "MM|PERCENT%",
                      "Corner radius of a bead's section, in mm or as a percentage of half its height (default "
                      "stadium, 100%)"),
              Completion::word, {"stadium"});
    plastic("--flow-lag", "SECONDS",
            "Simulates the flow, which follows the extruder with this lag: widths along beads, primes and what flows "
            "at rest; 0 alone lays primes where they are");
    plastic("--pressure-advance", "SECONDS",
            "For --flow-lag: the firmware's compensation, instead of the file's (M900, M572, SET_PRESSURE_ADVANCE)");
    plastic.flag("--strings", "For --flow-lag: what oozes on travels through air becomes strings; they hang by --sag");
    plastic("--crown", "FRACTION",
            "With settled beads: how far the edges of a line on a top surface lie below its middle, as a fraction of "
            "the layer's height (default 0)");
    plastic("--sag", "FRACTION", "How far a bead over nothing hangs down, as a fraction of the span (default 0)");
}

void addReadingOptions(CLI::App& app) {
    const Declarations reading(app, kReading);
    reading("--plate", "N", "Which plate of a .gcode.3mf that has several");
    reading.several("--filament-diameter", "MM,...", "By tool; overrides the file's settings");
    reading("--tool-offsets", "XxY,...",
            "Where nozzles are in the head, if the slicer subtracts it and the file does not state it");
    reading("--layer-height", "MM", "Where neither tags nor Z moves tell");
    reading("--belt", "DEGREES",
            "Of a belt printer: the angle between gantry and belt, e.g. 45, if the file does not state it");
    reading.flag("--planar", "Reads programs that turn the part or the nozzle (axes A, B, C) by X, Y and Z alone");
    completes(reading("--e-mode", "MODE", "How E counts at the start: auto, absolute, relative"), Completion::word,
              wordsOf(gcode::kExtruderModes));
    completes(reading("--planner", "RULE",
                      "How print times are planned: auto, jerk, slicer-jerk, plan-jerk, junction-deviation, "
                      "corner-velocity, marlin-jerk, reprap-jerk, programmed, bambu-jerk"),
              Completion::word, wordsOf(gcode::kCornerRules));
    completes(reading("--firmware", "NAME", "Whose rules hold: auto, marlin, klipper, reprap"), Completion::word,
              wordsOf(gcode::kFirmwares));
}

}  // namespace

void addPrintOptions(CLI::App& app, bool pictures) {
    addLatticeOptions(app, pictures);
    addSelectionOptions(app);
    addPlasticOptions(app);
    addReadingOptions(app);
}

void readPrintOptions(CommandSource& options, voxelize::PrintOptions& print, bool pictures) {
    assemble::readConversion(options, print, pictures);
    assemble::readReading(options, print);
}

void addMomentOptions(CLI::App& app, assemble::PrintRequest& request) {
    app.add_option("--printed", request.printed,
                   "G-code: what is printed by then: 25%, layer:40, time:90 (minutes; 5400s, 1.5h), or time:50%")
        ->type_name("WHEN")
        ->group(kWhat);
    app.add_option("--progress-series", request.series,
                   "G-code: N numbered pictures of a print that grows by equal volumes, one camera for all")
        ->check(CLI::Range(1, 100000))
        ->excludes("--printed")
        ->type_name("N")
        ->group(kWhat);
    app.add_flag("--by-time", request.series_by_time, "--progress-series: equal times instead of equal volumes")
        ->needs("--progress-series")
        ->group(kWhat);
}

std::vector<std::string> givenPrintOptions(const CLI::App& app) {
    constexpr std::array<std::string_view, 4> kGroups = {kLattice, kWhat, kPlastic, kReading};
    std::vector<std::string> given;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const bool of_prints = std::find(kGroups.begin(), kGroups.end(), option->get_group()) != kGroups.end();
        if (of_prints && option->count() > 0) given.push_back(name);
    }
    return given;
}

void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb) {
    if (given.empty()) return;
    const std::string& first = given.front();
    const bool in_time = first == "--printed" || first == "--progress-series";
    throw UsageError(
        fmt::format("{}: needs G-code, and {} is a level set, whose voxels are made; make it anew with gcode2vdb {}, "
                    "or give vdbtrace "
                    "the print itself",
                    fmt::join(given, ", "), vdb, in_time ? "--snapshots" : first));
}

}  // namespace stratum::tools
