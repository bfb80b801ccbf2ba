#include "print_options.h"

#include "choices.h"

#include "deposit/printer.h"
#include "gcode/machine/belt.h"
#include "gcode/option_names.h"
#include "gcode/printer/machine_limits.h"
#include "gcode/slicer/settings.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {

namespace {

void addLatticeOptions(CLI::App& app, voxelize::PrintOptions& options, bool pictures) {
    const char* lattice = kLattice;
    const auto take_size = [&options, pictures](const std::string& text) {
        options.voxel_auto = pictures && text == "auto";
        options.lattice.voxel_size.reset();
        if (options.voxel_auto) return;
        double value = 0;
        if (!CLI::detail::lexical_cast(text, value)) throw CLI::ConversionError(text, "--voxel-size");
        options.lattice.voxel_size = value;
    };
    auto* size =
        app.add_option_function<std::string>(
               "--voxel-size", take_size,
               pictures ? "Edge of a voxel; auto: half of what a pixel spans where the print is nearest to the camera"
                        : "Edge of a voxel")
            ->type_name(pictures ? "MM|auto" : "MM")
            ->group(lattice);
    app.add_option("--voxels-per-layer", options.lattice.voxels_per_layer, "Voxels in a layer height (1 to 64)")
        ->type_name("N")
        ->excludes(size)
        ->group(lattice);
    app.add_option("--tolerance", options.tolerance, "Coarsest voxel whose surface stays this near to the beads")
        ->type_name("MM")
        ->excludes("--voxel-size")
        ->excludes("--voxels-per-layer")
        ->group(lattice);
    app.add_option("--memory-budget", options.memory_budget, "Finest voxel that fits, e.g. 4GB or 4GiB")
        ->type_name("SIZE")
        ->excludes("--voxel-size")
        ->excludes("--voxels-per-layer")
        ->excludes("--tolerance")
        ->group(lattice);
    app.add_option("--half-width", options.lattice.half_width, "Narrow band to each side (default 3)")
        ->type_name("VOXELS")
        ->group(lattice);
}

void addSelectionOptions(CLI::App& app, voxelize::PrintOptions& options) {
    const char* what = kWhat;
    app.add_option("--layers", options.layers, "Only layers A to B, counted from 1; 0 is prime lines (default 1:)")
        ->type_name("A:B")
        ->group(what);
    std::vector<std::string> features;
    for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
        features.emplace_back(gcode::featureName(static_cast<gcode::Feature>(f)));
    completes(app.add_option("--features", options.features,
                             "Only (+NAME,...) or all but (-NAME,...) these features; all: also what meshes leave out"),
              Completion::selection, features)
        ->type_name("LIST")
        ->group(what);
    app.add_option("--object", options.objects, "Only this object of the print; may be given again for more")
        ->allow_extra_args(false)
        ->type_name("NAME|NUMBER")
        ->group(what);
    app.add_option_function<std::vector<unsigned>>(
           "--tool",
           [&options](const std::vector<unsigned>& tools) { options.tools.assign(tools.begin(), tools.end()); },
           "Only what these tools (T numbers) print; may be given again for more")
        ->delimiter(',')
        ->check(CLI::Range(0, 255))
        ->allow_extra_args(false)
        ->type_name("N,...")
        ->group(what);
}

void addPlasticOptions(CLI::App& app, voxelize::PrintOptions& options) {
    const char* plastic = kPlastic;
    // First: the options after it override what the preset says.
    completes(
        app.add_option_function<std::string>(
            "--printer",
            [&options](const std::string& preset) {
                deposit::usePrinter(preset, options.read);
                options.printer = preset;
            },
            "What the printer makes of the program: ideal: beads as commanded (default); typical: a model of a "
            "tuned printer, all effects below; or a file: its limits, for true times, from Klipper's printer.cfg, "
            "RepRapFirmware's config.g or a report of Marlin's M503, or all of it as JSON. Other options override "
            "it"),
        Completion::preset, {"ideal", "typical"})
        ->type_name("PRESET|FILE")
        ->group(plastic);
    app.add_option("--flow", options.read.flow_percent,
                   "Extrusion in per cent of what the file says, as a knob on the printer or M221 (default 100)")
        ->check(CLI::Range(1.0, gcode::kMostFlow))
        ->type_name("PERCENT")
        ->group(plastic);
    app.add_option(
           "--beads", options.read.deposit.beads,
           "What overlapping beads do: capsule: nothing, they are united (default); settled: what two neighbours "
           "both claim fills the groove between them, and what has no room there presses outlines out and raises "
           "tops; grooves: only the first of both")
        ->transform(enumeration(gcode::kBeadModels))
        ->type_name("MODEL")
        ->group(plastic);
    completes(
        app.add_option_function<std::string>(
            "--section", [&options](const std::string& text) { deposit::parseSection(text, options.read.deposit); },
            "Corner radius of a bead's section, in mm or as a percentage of half its height (default stadium, "
            "100%)"),
        Completion::word, {"stadium"})
        ->type_name("MM|PERCENT%")
        ->group(plastic);
    app.add_option("--flow-lag", options.read.deposit.flow_lag,
                   "Simulates the flow, which follows the extruder with this lag: widths along beads, primes and what "
                   "flows at rest; 0 alone lays primes where they are")
        ->check(CLI::Range(0.0, deposit::kLongestLag))
        ->type_name("SECONDS")
        ->group(plastic);
    app.add_option(
           "--pressure-advance", options.read.deposit.pressure_advance,
           "For --flow-lag: the firmware's compensation, instead of the file's (M900, M572, SET_PRESSURE_ADVANCE)")
        ->check(CLI::Range(0.0, gcode::kLongestAdvance))
        ->type_name("SECONDS")
        ->group(plastic);
    app.add_flag("--strings", options.read.deposit.strings,
                 "For --flow-lag: what oozes on travels through air becomes strings; they hang by --sag")
        ->group(plastic);
    app.add_option("--crown", options.read.deposit.crown,
                   "With settled beads: how far the edges of a line on a top surface lie below its middle, as a "
                   "fraction of the layer's height (default 0)")
        ->check(CLI::Range(0.0, gcode::kMostCrown))
        ->type_name("FRACTION")
        ->group(plastic);
    app.add_option("--sag", options.read.deposit.sag,
                   "How far a bead over nothing hangs down, as a fraction of the span (default 0)")
        ->check(CLI::Range(0.0, deposit::kMostSag))
        ->type_name("FRACTION")
        ->group(plastic);
}

void addReadingOptions(CLI::App& app, voxelize::PrintOptions& options) {
    const char* reading = kReading;
    app.add_option("--plate", options.read.plate, "Which plate of a .gcode.3mf that has several")
        ->check(CLI::PositiveNumber)
        ->type_name("N")
        ->group(reading);
    app.add_option("--filament-diameter", options.read.filament_diameters, "By tool; overrides the file's settings")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(0.1, 20.0))
        ->type_name("MM,...")
        ->group(reading);
    app.add_option_function<std::string>(
           "--tool-offsets",
           [&options](const std::string& text) {
               options.read.tool_offsets = gcode::toolOffsetsOf(text, "--tool-offsets");
           },
           "Where nozzles are in the head, if the slicer subtracts it and the file does not state it")
        ->type_name("XxY,...")
        ->group(reading);
    app.add_option("--layer-height", options.read.layer_height, "Where neither tags nor Z moves tell")
        ->check(CLI::Range(0.001, 50.0))
        ->type_name("MM")
        ->group(reading);
    app.add_option("--belt", options.read.belt_angle,
                   "Of a belt printer: the angle between gantry and belt, e.g. 45, if the file does not state it")
        ->check(CLI::Range(gcode::kFlattestBelt, gcode::kSteepestBelt))
        ->type_name("DEGREES")
        ->group(reading);
    app.add_flag("--planar", options.read.planar,
                 "Reads programs that turn the part or the nozzle (axes A, B, C) by X, Y and Z alone")
        ->group(reading);
    app.add_option("--e-mode", options.read.extruder_mode, "How E counts at the start: auto, absolute, relative")
        ->transform(enumeration(gcode::kExtruderModes))
        ->type_name("MODE")
        ->group(reading);
    app.add_option(
           "--planner", options.read.corner_rule,
           "How print times are planned: auto, jerk, slicer-jerk, plan-jerk, junction-deviation, corner-velocity, "
           "marlin-jerk, reprap-jerk, programmed, bambu-jerk")
        ->transform(enumeration(gcode::kCornerRules))
        ->type_name("RULE")
        ->group(reading);
    app.add_option("--firmware", options.read.firmware, "Whose rules hold: auto, marlin, klipper, reprap")
        ->transform(enumeration(gcode::kFirmwares))
        ->type_name("NAME")
        ->group(reading);
}

}  // namespace

void addPrintOptions(CLI::App& app, voxelize::PrintOptions& options, bool pictures) {
    addLatticeOptions(app, options, pictures);
    addSelectionOptions(app, options);
    addPlasticOptions(app, options);
    addReadingOptions(app, options);
}

}  // namespace stratum::tools
