#include "gcode/reader.h"

#include "base/error.h"
#include "base/utf8.h"
#include "gcode/container/container.h"
#include "gcode/filament.h"
#include "gcode/machine/bead_recorder.h"
#include "gcode/machine/belt.h"
#include "gcode/machine/machine.h"
#include "gcode/machine/motion_recorder.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/slicer/settings.h"
#include "gcode/text/lexer.h"
#include "gcode/text/trade.h"
#include "gcode/toolpath/sections.h"
#include "gcode/toolpath/warning_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace stratum::gcode {
namespace {

constexpr std::size_t kProgressBytes = std::size_t{1} << 20;
constexpr std::size_t kBytesPerBead = 26;  // the densest real files have 30; memory never touched costs nothing

bool isBeltAngle(double degrees) { return degrees >= kFlattestBelt && degrees <= kSteepestBelt; }

void checkOptions(const ReadOptions& options) {
    for (const double diameter : options.filament_diameters)
        if (!(diameter >= 0.1 && diameter <= 100))
            throw UsageError(fmt::format("filament diameter {} mm: expected 0.1 to 100, e.g. 1.75 or 2.85", diameter));
    if (options.printer && options.printer->firmware != Firmware::automatic &&
        options.firmware != Firmware::automatic && options.firmware != options.printer->firmware)
        throw UsageError(fmt::format("{} is of {}, not of {}; leave out one of the two", options.printer->name,
                                     firmwareName(options.printer->firmware), firmwareName(options.firmware)));
    if (options.layer_height && !(*options.layer_height >= 0.001 && *options.layer_height <= 100))
        throw UsageError(fmt::format("layer height {} mm: expected 0.001 to 100, e.g. 0.2", *options.layer_height));
    if (options.belt_angle && !isBeltAngle(*options.belt_angle))
        throw UsageError(
            fmt::format("belt angle {} degrees: expected {} to {}, the angle between gantry and belt, e.g. "
                        "45",
                        *options.belt_angle, kFlattestBelt, kSteepestBelt));
}

[[noreturn]] void refuseWithoutBeads(const MoveCounts& counts, std::string_view text, std::string_view name) {
    if (const std::string trade = describeTrade(text); !trade.empty())
        throw InputError(fmt::format("{}: no extruding move: this is {}", name, trade));
    if (counts.commands == 0)
        throw InputError(fmt::format("{}: no G-code command in it; give the slicer's .gcode file", name));
    throw InputError(
        fmt::format("{}: no extruding move: {} travel moves, {} primes on the spot, no motion with rising E; is this a "
                    "laser or CNC program, or a tool test?",
                    name, counts.travels, counts.stationary));
}

// A file truncated at a block's end has no other fault.
void warnIfShort(double filament_mm, const Program& program, std::uint32_t last_line, WarningLog& warnings) {
    if (program.filament_mm && filament_mm < 0.99 * *program.filament_mm)
        warnings.add(
            fmt::format("only {:.1f} of the {:.1f} mm of filament that the {} container states are extruded; the "
                        "file may be cut off",
                        filament_mm, *program.filament_mm, program.format),
            last_line);
}

// The container's statements are used only where the text has none.
void takeStated(const StatedFacts& text, const StatedFacts& container, StatedFacts& stated) {
    stated = text;
    if (!stated.seconds) stated.seconds = container.seconds;
    if (!stated.grams) stated.grams = container.grams;
    if (stated.printer.empty()) stated.printer = container.printer;
    if (stated.materials.empty()) stated.materials = container.materials;
}

// By tool; a ufp lists each material once, so its list is by tool only if it is as long as the list of tools.
void takeColors(const Program& program, Toolpath& toolpath) {
    const std::vector<std::optional<Rgb>>& colors = program.facts.filament_colors;
    if (!toolpath.tool_colors.empty() || colors.empty()) return;
    if (program.format == "ufp" && colors.size() != toolpath.filament_by_tool.size()) return;
    toolpath.tool_colors = colors;
}

// Colors that are asked for are those of the filaments, which a mixing hot end feeds together. Those of a file are the
// slicer's, of each tool as it lays it.
void takeAskedColors(const ReadOptions& options, const std::vector<MixChange>& mixes, Toolpath& toolpath,
                     WarningLog& warnings) {
    const auto& asked = options.filament_colors;
    if (!mixes.empty() && asked.empty())
        warnings.add(
            "the program mixes filaments (M163 to M165, M567); --color NAME,NAME,... says which, and gives the "
            "mixes their colours",
            mixes.front().line);
    if (toolpath.tool_colors.size() < asked.size()) toolpath.tool_colors.resize(asked.size());
    for (std::size_t n = 0; n < asked.size(); ++n)
        if (asked[n]) toolpath.tool_colors[n] = asked[n];
    if (!asked.empty() && addMixes(mixes, toolpath.tool_colors, toolpath) > 0)
        warnings.add("the program mixes more filaments than have a colour; those mixes keep the colour before",
                     mixes.front().line);
}

// BambuStudio and OrcaSlicer label objects by number in the text; the names stand beside it. Equal names get their
// numbers, so that each can be chosen.
void nameObjects(const Program& program, Toolpath& toolpath) {
    std::unordered_map<std::string_view, std::string_view> names;  // by number
    std::unordered_map<std::string_view, std::size_t> uses;
    for (const auto& [number, name] : program.facts.object_names) {
        names.try_emplace(number, name);
        ++uses[name];
    }
    for (std::string& object : toolpath.objects) {
        if (!object.starts_with(kObjectNumber)) continue;
        const std::string number = object.substr(kObjectNumber.size());
        const auto named = names.find(number);
        if (named == names.end()) continue;
        object = uses[named->second] > 1 ? fmt::format("{} {}", named->second, number) : std::string(named->second);
    }
}

// As given, else as the file states it.
std::optional<double> beltAngle(const ReadOptions& options, const StatedFacts& stated, WarningLog& warnings) {
    if (options.belt_angle) return options.belt_angle;
    if (stated.belt && stated.belt_angle && isBeltAngle(*stated.belt_angle)) return stated.belt_angle;
    const auto warn = [&warnings](std::string_view name) {
        warnings.add(fmt::format("{} prints on a belt, which Z moves: without the angle of its gantry (--belt 45) the "
                                 "print is skewed",
                                 name),
                     1);
    };
    for (const std::string_view name : {"CR-30", "CR30", "BLACKBELT", "BlackBelt", "Blackbelt"})
        if (stated.printer.find(name) != std::string_view::npos) {
            warn(name);
            return {};
        }
    if (stated.belt) warn("the printer");
    return {};
}

// Once for all who show it: JSON, pages and Python take nothing else.
void makeTextUtf8(Toolpath& toolpath) {
    StatedFacts& stated = toolpath.stated;
    for (std::string* text : {&toolpath.slicer, &toolpath.firmware_reason, &toolpath.extrusion_rule, &stated.printer})
        *text = utf8Text(*text);
    for (auto* list : {&toolpath.objects, &stated.materials, &stated.profiles})
        for (std::string& text : *list) text = utf8Text(text);
    for (Warning& warning : toolpath.warnings) warning.text = utf8Text(warning.text);
}

}  // namespace

Toolpath readToolpath(std::string_view bytes, std::string_view name, const ReadOptions& options) {
    checkOptions(options);
    // Unpacking takes about as long as parsing.
    constexpr double kUnpackingShare = 0.5;
    Progress unpacking;
    if (options.progress) unpacking = [&options](double fraction) { options.progress(kUnpackingShare * fraction); };
    const Program program = openContainer(bytes, name, options.plate, {}, unpacking);
    const double before = program.unpacked.size() > 0 ? kUnpackingShare : 0;
    const std::string_view text = withoutZeroTail(program.text);
    refuseOtherFormats(text.empty() ? program.text : text, name);
    Settings settings = readSettings(text);
    if (!program.cut_short.empty()) settings.cut_short = program.cut_short;
    if (!options.tool_offsets.empty()) settings.tool_offsets = options.tool_offsets;
    const std::optional<double> nominal = options.layer_height ? options.layer_height : settings.layer_height;

    WarningLog warnings;
    if (!settings.damaged_part.empty())
        warnings.add(fmt::format("{} is damaged; its settings are left out", settings.damaged_part), 1);
    ReadOptions read = options;
    read.belt_angle = beltAngle(options, settings.stated, warnings);
    BeadRecorder recorder(nominal.value_or(0.2), text.size() / kBytesPerBead, warnings);
    for (const std::string_view kin : {"Slic3r", "PrusaSlicer", "SuperSlicer"})
        if (settings.slicer.starts_with(kin)) recorder.letMarksRepeat();
    Machine machine(settings, read, name, recorder, warnings);
    std::optional<MotionRecorder> motion;
    if (options.motion != nullptr) {
        motion.emplace(
            *options.motion,
            readMachineSettings(text, options.corner_rule, options.printer, machine.firmware(), settings.slicer_limits),
            warnings, options.deposit.flow_lag.has_value());
        machine.recordMotion(&*motion);
    }
    Lexer lexer(text);
    Line line;
    std::size_t reported = 0;
    while (lexer.next(line)) {
        machine.run(line);
        if (options.progress && lexer.offset() - reported >= kProgressBytes) {
            reported = lexer.offset();
            options.progress(before + (1 - before) * static_cast<double>(reported) / static_cast<double>(text.size()));
        }
    }
    recorder.finish();
    if (motion) motion->finish();
    Toolpath& recorded = recorder.toolpath();
    if (recorded.empty()) refuseWithoutBeads(machine.counts(), text, name);
    const bool filament_known = takeFilament(settings.footer, machine, recorded, warnings);
    resolveHeights(recorded, recorder.runZ(), nominal, warnings);
    recorder.countPlainMarks();
    if (!filament_known) chooseFilament(settings.nozzle_diameter, recorded, warnings);
    resolveSections(recorded, recorder.runZ(), nominal, warnings);
    warnOfMixedFilaments(machine, recorded, warnings);
    warnIfShort(machine.filamentMm(), program, line.number, warnings);
    if (options.progress) options.progress(1);

    Toolpath toolpath = std::move(recorded);
    toolpath.deposit = options.deposit;
    toolpath.belt_angle = read.belt_angle.value_or(0);
    toolpath.slicer = settings.slicer;
    toolpath.firmware = firmwareName(machine.firmware());
    toolpath.layer_height = nominal.value_or(0);
    for (const Run& run : toolpath.runs) toolpath.layer_count = std::max(toolpath.layer_count, run.layer);
    toolpath.format = program.format;
    takeStated(settings.stated, program.facts.stated, toolpath.stated);
    takeColors(program, toolpath);
    takeAskedColors(options, recorder.mixes(), toolpath, warnings);
    colorUnstated(toolpath);
    toolpath.warnings = warnings.take();
    nameObjects(program, toolpath);
    if (!(toolpath.footer_mm > 0)) toolpath.footer_mm = program.filament_mm.value_or(0);
    makeTextUtf8(toolpath);
    return toolpath;
}

}  // namespace stratum::gcode
