#include "gcode/machine/machine.h"

#include "base/error.h"
#include "base/text.h"
#include "gcode/slicer/slicer_tags.h"
#include "gcode/text/known_commands.h"
#include "gcode/text/limits.h"
#include "gcode/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace stratum::gcode {
namespace {

constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};
// Numbers from here on are requests to the firmware, not tools (PrusaSlicer and Bambu machines).
constexpr int kNoTool = 255;

Firmware chooseFirmware(const Settings& settings, const ReadOptions& options) {
    if (options.firmware != Firmware::automatic) return options.firmware;
    if (options.printer && options.printer->firmware != Firmware::automatic) return options.printer->firmware;
    return settings.firmware != Firmware::automatic ? settings.firmware : Firmware::marlin;
}

bool hasAxis(const Command& command) { return command.has('X') || command.has('Y') || command.has('Z'); }

// The number of G54..G59 and G59.1..G59.3 in Frame.
std::size_t workspaceOf(const Command& command) {
    return static_cast<std::size_t>(command.code - 53 + (command.code == 59 ? std::clamp(command.subcode, 0, 3) : 0));
}

}  // namespace

std::string_view firmwareName(Firmware firmware) {
    switch (firmware) {
        case Firmware::marlin:
            return "marlin";
        case Firmware::klipper:
            return "klipper";
        case Firmware::reprap:
            return "reprap";
        case Firmware::automatic:
            break;
    }
    return "automatic";
}

Machine::Machine(const Settings& settings, const ReadOptions& options, std::string_view name, BeadRecorder& recorder,
                 WarningLog& warnings)
    : settings_(settings),
      name_(name),
      recorder_(recorder),
      warnings_(warnings),
      firmware_(chooseFirmware(settings, options)),
      filament_override_(options.filament_diameters),
      volumetric_reason_(settings.volumetric_reason),
      nominal_height_(options.layer_height.value_or(settings.layer_height.value_or(0))),
      // RepRapFirmware starts in G54, Marlin in the machine's own coordinates.
      frame_(firmware_ == Firmware::reprap ? 1 : 0),
      volumetric_(settings.volumetric_e.value_or(false)),
      all_flow_(options.flow_percent / 100),
      planar_(options.planar),
      simulates_flow_(options.deposit.flow_lag.has_value()),
      extra_axes_(settings.extrusion.drive != ExtrusionScan::Drive::axes_ab),
      carriages_(warnings) {
    if (!(all_flow_ > 0 && options.flow_percent <= kMostFlow))
        throw UsageError(
            fmt::format("a flow of {:g} %; expected a number above 0, at most {:g}", options.flow_percent, kMostFlow));
    flow_.fill(all_flow_);
    if (options.belt_angle) belt_.emplace(*options.belt_angle);
    if (options.extruder_mode != ExtruderMode::automatic) {
        e_absolute_ = options.extruder_mode == ExtruderMode::absolute;
        e_mode_known_ = true;
    }
    Toolpath& toolpath = recorder_.toolpath();
    toolpath.tool_colors = settings.tool_colors;
    toolpath.cut_short = settings.cut_short;
    toolpath.firmware_reason = options.firmware != Firmware::automatic ? "as asked for"
                               : options.printer && options.printer->firmware != Firmware::automatic
                                   ? "as " + options.printer->name + " says"
                               : settings.firmware != Firmware::automatic ? settings.firmware_reason
                                                                          : "the file doesn't say otherwise";
    if (!settings.tool_offsets.empty()) useTool(0);
}

void Machine::refuse(std::string_view what) const { throw InputError(fmt::format("{}:{}: {}", name_, line_, what)); }

void Machine::heed(const Tag& tag, const Line& line) {
    // Between ;TYPE: lines, verbose moves name less: "perimeter" for an outer wall, too.
    const bool behind_move = tag.bare && line.count > 0;
    if (behind_move && types_stated_) return;
    if (tag.kind == Tag::Kind::feature && !tag.bare && tag.feature != Feature::custom) types_stated_ = true;
    if (tag.kind == Tag::Kind::object_start) {
        if (!objects_by_comment_) recorder_.stopObject();  // a macro's, whose end does not count from here on
        objects_by_comment_ = true;
    }
    if (tag.kind == Tag::Kind::filament_loaded) loaded();
    flushing_ = flushing_ ? tag.kind != Tag::Kind::flush_stop : tag.kind == Tag::Kind::flush_start;
    if (tag.kind == Tag::Kind::units_set && line.count > 0 && line.commands[0].code == 21) recorder_.startPart();
    recorder_.tag(tag, line_);
}

void Machine::run(const Line& line) {
    line_ = line.number;
    // The comment first: Slic3r writes the feature of a move behind the move.
    if (!line.comment.empty()) {
        if (const Tag tag = parseTag(line.comment); tag.kind != Tag::Kind::none)
            heed(tag, line);
        else if (isPlainLayerMark(line.comment))
            recorder_.plainMark();
        if (moves_ != nullptr) tellElapsed(line.comment);
        flushByItself(line.comment);
    }
    std::optional<std::size_t> workspace;
    for (std::size_t i = 0; i < line.count; ++i) {
        const Command& command = line.commands[i];
        const bool moves = command.kind == Command::Kind::words || command.letter == 'G';
        if (line.unreadable && moves) warnUnreadable(line);
        // G53 before another command holds for that command only.
        if (command.letter == 'G' && command.code == 53 && i + 1 < line.count) workspace = frame_.workspace();
        execute(command);
    }
    if (workspace) frame_.select(*workspace);
    if (line.deleted) warn("a line that begins with '/' (block delete) is left out");
    if (line.unreadable && line.count == 0) warnUnreadable(line);
}

void Machine::tellElapsed(std::string_view comment) {
    constexpr std::string_view kElapsed = "TIME_ELAPSED:";
    if (!comment.starts_with(kElapsed)) return;
    if (const auto seconds = parseDuration(comment.substr(kElapsed.size()))) moves_->elapsed(*seconds);
}

// Bambu's printers with two nozzles flush by themselves; how much and how long, the slicer writes as moves of E that
// the printer skips: ";VG1 E4 F299".
void Machine::flushByItself(std::string_view comment) {
    constexpr std::string_view kFlush = "VG1 E";
    if (!comment.starts_with(kFlush)) return;
    const char* at = comment.data() + kFlush.size();
    const char* const end = comment.data() + comment.size();
    double length = 0;
    if (!parseNumber(at, end, length) || !(length > 0 && length <= kMaxExtrusion)) return;
    if (flushing_) flushed_ += length;
    const auto f = comment.find('F');
    if (moves_ == nullptr || f == std::string_view::npos) return;
    at = comment.data() + f + 1;
    double speed = 0;
    if (parseNumber(at, end, speed) && speed > 0) moves_->wait(60 * length / speed);
}

void Machine::warnUnreadable(const Line& line) {
    if (!line.decimal_comma) return warnNoWords();
    warn(
        "decimal commas: printers read X10,5 as X10, and so it is read here; slice with a language that writes points, "
        "or replace the commas by points");
}

void Machine::warnNoWords() { warn("characters that are no G-code words; they are ignored"); }

void Machine::execute(const Command& command) {
    switch (command.kind) {
        case Command::Kind::words:
            if (!hasAxis(command)) useExtruderOf(extruderAxis(command));
            if (hasAxis(command) || extruderAxis(command) != 0) move(command, motion_);
            return;
        case Command::Kind::foreign:
            return remarkForeign(command);
        case Command::Kind::extended:
            return executeMacro(command);
        case Command::Kind::numbered:
            break;
    }
    ++counts_.commands;
    if (moves_ != nullptr) moves_->command(command, unit_, line_);
    if (command.letter == 'G') return executeG(command);
    if (command.letter == 'M') return executeM(command);
    selectTool(command);
}

void Machine::executeG(const Command& command) {
    switch (command.code) {
        case 0:
        case 1:
        case 2:
        case 3:
        case 5:
            motion_ = command.code;
            return move(command, motion_);
        case 10:
            return setOffsets(command);
        case 17:
            plane_ = {0, 1};
            return;
        case 18:
            plane_ = {2, 0};
            return;
        case 19:
            plane_ = {1, 2};
            return;
        case 20:
            unit_ = 25.4;
            return;
        case 21:
            unit_ = 1;
            return;
        case 28:
            return home(command);
        case 161:
        case 162:
            makerbot_ = true;
            return;
        case 53:
        case 54:
        case 55:
        case 56:
        case 57:
        case 58:
        case 59:
            if (!makerbot_) frame_.select(workspaceOf(command));
            return;
        case 60:
            return storePosition(command);
        case 61:
            return returnToPosition(command);
        case 90:
        case 91:
            return setAbsolute(command);
        case 92:
            return setPosition(command);
        case 93:
        case 94:
            inverse_time_ = command.code == 93;
            return;
        default:
            if (!isHarmless('G', command.code)) warn(fmt::format("unknown command G{}, ignored", command.code));
    }
}

void Machine::executeM(const Command& command) {
    switch (command.code) {
        case 82:
        case 83:
            e_absolute_ = command.code == 82;
            m83_ = !e_absolute_;
            e_mode_known_ = true;
            return;
        case 101:
        case 102:
        case 103:
            motor_on_ = command.code == 101;
            return;
        case 104:
        case 106:
        case 107:
        case 109:
            return setHeatOrFan(command);
        case 108:
        case 135:
            // MakerBot's machines and FlashForge's. Elsewhere these have no T.
            if (command.hasValue('T')) changeMakerBotTool(command.value('T'));
            return;
        case 163:
        case 164:
        case 165:
        case 166:
        case 567:
            return mixFilaments(command);
        case 200:
            return setVolumetric(command);
        case 206:
            return setHomeOffset(command);
        case 220:
            return setSpeedFactor(command);
        case 204:
            // S is for all moves, P for those that print.
            return recorder_.accelerate(command.value(command.hasValue('S') ? 'S' : 'P') * unit_, line_);
        case 221:
            return setFlow(command);
        case 486:
            return labelObject(command);
        case 572:
            return setAdvance(command, 'S', 'D');  // RepRapFirmware
        case 600:
            return recorder_.changeFilament(line_);
        case 605:
            carriages_.setMode(command, frame_.position().x, unit_, line_);
            if (carriages_.copies() && simulates_flow_)
                warn("the flow of one nozzle is simulated (--flow-lag): the copy that M605 prints is left out");
            return;
        case 900:
            return setAdvance(command, 'K', 'T');  // Marlin, Bambu's
        case 1020:                                 // Bambu's machines with two nozzles
            if (command.hasValue('S')) useNumberedTool(command.value('S'));
            return;
        default:
            if (!isHarmless('M', command.code)) warn(fmt::format("unknown command M{}, ignored", command.code));
    }
}

void Machine::selectTool(const Command& command) {
    constexpr int kToolChange = 2;  // the slot that RepRapFirmware fills itself
    if (firmware_ == Firmware::reprap && command.code >= 0 && command.code < kNoTool)
        stored_.insert_or_assign(kToolChange, Stored{frame_.position(), e_});
    useNumberedTool(command.code);
}

void Machine::useNumberedTool(double number) {
    if (number >= 0 && number < kNoTool) useTool(static_cast<std::size_t>(number));
}

// Some of these programs count absolute E for each tool, others for all together: the next E tells.
void Machine::changeMakerBotTool(double number) {
    e_by_tool_[tool_] = e_;
    const std::size_t before = tool_;
    useNumberedTool(number);
    if (tool_ != before) tool_e_ = e_by_tool_[tool_];
}

void Machine::useTool(std::size_t tool) {
    if (moves_ != nullptr) moves_->changeTool(tool_, tool, line_);
    beads_at_tool_ = recorder_.toolpath().beads.size();
    tool_ = tool;
    recorder_.setTool(static_cast<std::uint8_t>(tool));
    // PrusaSlicer and its derivatives subtract a nozzle's offset from the coordinates. Offsets that the firmware
    // applies (M218, G10 P) are ignored: there the program's coordinates are those of the material.
    const auto& offsets = settings_.tool_offsets;
    if (!offsets.empty()) frame_.setToolOffset(tool < offsets.size() ? offsets[tool] : Point{});
}

double Machine::coordinateOf(const Command& command, char letter) const {
    // As in Marlin, an axis without a number is set to 0.
    const double value = command.hasValue(letter) ? command.value(letter) * unit_ : 0;
    if (!(std::abs(value) <= kMaxCoordinate))
        refuse(fmt::format("{}{} is no place on a printer (limit {} mm); is the file damaged?", letter,
                           command.value(letter), kMaxCoordinate));
    return value;
}

void Machine::setOffsets(const Command& command) {
    // Without L a retraction, or with P a tool's offsets and temperatures: never a bead.
    if (command.hasValue('P') && command.hasValue('S') && !command.hasValue('L'))
        recorder_.heat(command.value('P'), command.value('S'), line_);
    if (!command.hasValue('L')) return;
    const double kind = command.value('L');
    if (kind != 2 && kind != 20) return;
    const double number = command.hasValue('P') ? command.value('P') : 0;
    if (!(number >= 0 && number < static_cast<double>(Frame::kWorkspaces))) return warn("G10 of no known workspace");
    const std::size_t workspace = number < 1 ? frame_.workspace() : static_cast<std::size_t>(number);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!command.hasValue(kAxes[axis])) continue;
        const double value = coordinateOf(command, kAxes[axis]);
        kind == 2 ? frame_.setWorkspaceOrigin(workspace, axis, value)
                  : frame_.setWorkspacePosition(workspace, axis, value);
    }
}

void Machine::home(const Command& command) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!hasAxis(command) || command.has(kAxes[axis])) frame_.home(axis);
}

void Machine::setPosition(const Command& command) {
    if (command.subcode == 1) return frame_.clearG92Offsets();
    if (command.subcode == 2) return frame_.suspendG92Offsets();
    if (command.subcode == 3) return frame_.resumeG92Offsets();
    if (command.subcode != 0) return;
    if (extra_axes_.has(command)) extra_axes_.setPosition(command, unit_);
    const char letter = extruderAxis(command);
    useExtruderOf(letter);
    const bool extruder = letter != 0;
    const bool bare = !hasAxis(command) && !extruder && !extra_axes_.has(command);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (bare || (command.has(kAxes[axis]) && !command.isExpression(kAxes[axis])))
            frame_.setG92Position(axis, coordinateOf(command, kAxes[axis]));
    if ((!bare && !extruder) || (letter != 0 && command.isExpression(letter))) return;
    const double value = letter != 0 && command.hasValue(letter) ? command.value(letter) * eUnit() : 0;
    if (!std::isfinite(value)) refuse("the E of this G92 is no number; is the file damaged?");
    e_ = value;
    tool_e_.reset();
}

void Machine::setAbsolute(const Command& command) {
    const bool absolute = command.code == 90;
    if (command.subcode != 0) {  // of arcs' centers only: LinuxCNC's G90.1 and G91.1
        if (command.subcode == 1 && absolute) warn("G90.1 is nothing that printers know; I and J count from the start");
        return;
    }
    absolute_ = absolute;
    if (firmware_ != Firmware::marlin) return;
    // In Marlin 2 G90 undoes M83, in Marlin 1 it did not; slicers that set relative E rely on the latter and send G90
    // after.
    if (absolute && settings_.relative_e.value_or(false)) return;
    if (absolute && m83_ && settings_.extrusion.relative_after_g90) {
        e_absolute_ = false;
        return warn(
            "by Marlin's rules G90 makes E absolute again after M83, but E keeps falling back or stays the same, "
            "as only increments do; it stays relative (M82 in the file if not)");
    }
    e_absolute_ = absolute;
    e_follows_axes_ = true;
}

void Machine::remarkForeign(const Command& command) {
    // FlashPrint states the print's box as Q603; Prusa's XL parks tools with P0; WEEDO's pictures are W220 to W222; O,
    // S, D and H are a CNC program's number, spindle and tool.
    const std::string_view name = command.name;
    const std::string_view known = "OSDHWosdhw";
    if (name == "Q603" || name == "P0" || name.empty() || known.find(name.front()) != std::string_view::npos) return;
    warn(fmt::format("unknown command {}, ignored", name.substr(0, 60)));
}

void Machine::setHomeOffset(const Command& command) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (command.hasValue(kAxes[axis])) frame_.setHomeOffset(axis, coordinateOf(command, kAxes[axis]));
}

void Machine::setVolumetric(const Command& command) {
    // D alone switches it on, or off by 0; S of Marlin 2 has the last word: M503 reports "M200 S0 D1.75" where it is
    // off.
    if (command.hasValue('D')) {
        const double diameter = command.value('D') * unit_;
        if (!(diameter >= 0 && diameter <= kMaxFilament))
            refuse(fmt::format("M200 D{} is no filament diameter in mm", command.value('D')));
        volumetric_ = diameter > 0;
        const double tool = command.hasValue('T') ? command.value('T') : static_cast<double>(tool_);
        if (diameter > 0 && tool >= 0 && tool < kNoTool) m200_diameters_[static_cast<std::size_t>(tool)] = diameter;
    }
    if (command.hasValue('S')) volumetric_ = command.value('S') > 0 && (volumetric_ || !command.hasValue('D'));
    if (volumetric_) volumetric_reason_ = fmt::format("M200 in line {}", line_);
}

void Machine::mixFilaments(const Command& command) {
    if (command.code == 163) {
        if (!mixer_.setFactor(command)) warn("M163 of a filament that no mixing hot end has; ignored");
        return;
    }
    if (command.code == 166)
        return warn("M166 mixes a gradient over z, which is not followed; its colours are missing");
    if (command.code == 567 && firmware_ != Firmware::reprap) return;
    std::optional<ToolMix> mix = command.code == 164   ? mixer_.save(command, tool_)
                                 : command.code == 165 ? mixer_.setAll(command, tool_)
                                                       : Mixer::ofTool(command, tool_);
    if (mix) recorder_.changeMix(std::move(*mix), line_);
}

void Machine::labelObject(const Command& command) {
    if (objects_by_comment_) return;
    // "S3", "Acube one", "S3 A\"cube one\"": the name is the rest of the line; its letters are not parameters.
    std::string_view text = trim(command.text);
    const auto at = text.find_first_of("Aa");
    const bool named = at != std::string_view::npos && (at == 0 || text.substr(0, at).find_first_of("PUCT") > at);
    // PrusaSlicer from 2.8 on names all objects at the start, and calls them by their numbers alone later.
    if (command.hasValue('S') && !(named && at == 0)) {
        const double number = command.value('S');
        object_number_ = number < 0 || number > 65535 ? -1 : static_cast<int>(number);
        if (object_number_ < 0) return recorder_.stopObject();
        const auto known = object_names_.find(object_number_);
        recorder_.startObject(known != object_names_.end() ? known->second : fmt::format("object {}", object_number_),
                              line_);
    }
    if (!named) return;
    text = trim(text.substr(at + 1));
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    if (text.empty()) return;
    // Copies of one model that bear one name stay apart.
    std::string name(text);
    if (object_number_ >= 0) {
        std::string& own = object_names_[object_number_];
        if (const auto old = name_uses_.find(own); old != name_uses_.end() && --old->second == 0) name_uses_.erase(old);
        if (name_uses_.contains(name)) name += fmt::format(" {}", object_number_);
        ++name_uses_[name];
        own = name;
    }
    recorder_.renameObject(name, line_);
}

bool Machine::filamentKnown() const {
    // A motor that is switched counts no filament.
    return settings_.extrusion.drive == ExtrusionScan::Drive::switched || volumetric_ || !filament_override_.empty() ||
           !m200_diameters_.empty() || !settings_.filament_diameters.empty();
}

std::string Machine::extrusionRule() const {
    if (settings_.extrusion.drive == ExtrusionScan::Drive::switched) return "nothing: M101 and M103 switch the motor";
    if (volumetric_) return fmt::format("mm^3 ({})", volumetric_reason_);
    return fmt::format("mm of filament of {:g} mm ({})", filamentDiameter(0),
                       !filament_override_.empty()             ? "as asked for"
                       : !settings_.filament_diameters.empty() ? "the file's settings"
                       : !m200_diameters_.empty()              ? "an earlier M200"
                                                               : "assumed; the file doesn't say");
}

double Machine::filamentDiameter(std::size_t tool) const {
    const auto& list = filament_override_.empty() ? settings_.filament_diameters : filament_override_;
    if (!list.empty()) return list[std::min(tool, list.size() - 1)];
    if (m200_diameters_.empty()) return 1.75;
    const auto own = m200_diameters_.find(tool);
    return own != m200_diameters_.end() ? own->second : m200_diameters_.begin()->second;
}

double Machine::filamentArea() const {
    const double diameter = filamentDiameter(tool_);
    return std::numbers::pi / 4 * diameter * diameter;
}

}  // namespace stratum::gcode
