#include "gcode/machine.h"

#include "gcode/known_commands.h"
#include "gcode/slicer_tags.h"
#include "io/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

constexpr double kMaxCoordinate = 1e5;  // mm: no printer is a hundred metres wide
constexpr double kMaxExtrusion = 1e6;   // mm or mm^3 in one move
constexpr double kMaxFilament = 100;    // mm of diameter
constexpr double kMaxFlow = 1e4;        // per cent
constexpr double kNoMotion = 1e-9;      // mm
// Filament drawn back further than this, in mm, has left the nozzle: the longest retractions of Bowden printers are
// 16 mm, unloading takes 50 and more.
constexpr double kUnloaded = 25;

Firmware chooseFirmware(const Settings& settings, const ReadOptions& options) {
    if (options.firmware != Firmware::automatic) return options.firmware;
    return settings.firmware != Firmware::automatic ? settings.firmware : Firmware::marlin;
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
      filament_override_(options.filament_diameter),
      volumetric_(settings.volumetric_e.value_or(false)) {
    flow_.fill(1);
    if (options.extruder_mode != ExtruderMode::automatic) {
        e_absolute_ = options.extruder_mode == ExtruderMode::absolute;
        e_mode_known_ = true;
    }
}

void Machine::refuse(std::string_view what) const { throw InputError(fmt::format("{}:{}: {}", name_, line_, what)); }

void Machine::run(const Line& line) {
    line_ = line.number;
    // The comment first: Slic3r names a move's feature behind it.
    if (!line.comment.empty()) {
        const Tag tag = parseTag(line.comment);
        if (tag.kind == Tag::Kind::object_start) objects_by_comment_ = true;
        recorder_.tag(tag, line_);
    }
    for (std::size_t i = 0; i < line.count; ++i) {
        const bool moves = line.commands[i].kind == Command::Kind::words || line.commands[i].letter == 'G';
        if (line.unreadable && moves) warn("characters that are no G-code words; they are ignored");
        execute(line.commands[i]);
    }
    if (line.unreadable && line.count == 0) warn("characters that are no G-code words; they are ignored");
}

void Machine::execute(const Command& command) {
    switch (command.kind) {
        case Command::Kind::words:
            if (command.has('X') || command.has('Y') || command.has('Z') || command.has('E')) move(command, motion_);
            return;
        case Command::Kind::extended:
            return executeExtended(command);
        case Command::Kind::numbered:
            break;
    }
    ++counts_.commands;
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
            motion_ = command.code;
            return move(command, motion_);
        case 5:
            warn("G5 curve: drawn as a straight line");
            return move(command, 1);
        case 10:  // a retraction, or with L or P a tool's offset or temperature: never a bead
        case 11:
        case 21:
            if (command.code == 21) unit_ = 1;
            return;
        case 20:
            unit_ = 25.4;
            return;
        case 28:
            return home(command);
        case 90:
            return setAbsolute(command.subcode == 1 ? absolute_ : true);
        case 91:
            return setAbsolute(command.subcode == 1 ? absolute_ : false);
        case 92:
            return setPosition(command);
        default:
            if (!isHarmless('G', command.code)) warn(fmt::format("unknown command G{}, ignored", command.code));
    }
}

void Machine::executeM(const Command& command) {
    switch (command.code) {
        case 82:
        case 83:
            e_absolute_ = command.code == 82;
            e_mode_known_ = true;
            return;
        case 200:
            return setVolumetric(command);
        case 221:
            return setFlow(command);
        case 486:
            return labelObject(command);
        default:
            if (!isHarmless('M', command.code)) warn(fmt::format("unknown command M{}, ignored", command.code));
    }
}

void Machine::executeExtended(const Command& command) {
    if (command.name == "EXCLUDE_OBJECT_START") {
        const auto at = command.text.find("NAME=");
        if (at == std::string_view::npos || objects_by_comment_) return;
        const std::string_view name = command.text.substr(at + 5);
        return recorder_.startObject(name.substr(0, name.find_first_of(" \t")), line_);
    }
    if (command.name == "EXCLUDE_OBJECT_END") {
        if (!objects_by_comment_) recorder_.stopObject();
        return;
    }
    warn(fmt::format("macro {} is not in the file; what it prints or moves is not in the toolpath",
                     command.name.substr(0, 60)));
}

void Machine::selectTool(const Command& command) {
    // Numbers from 255 up are requests to the firmware, not tools (PrusaSlicer and Bambu machines).
    if (command.code < 0 || command.code >= 255) return;
    tool_ = static_cast<std::size_t>(command.code);
    recorder_.setTool(static_cast<std::uint8_t>(tool_));
}

double Machine::takeAxis(const Command& command, char letter, double current, double offset) const {
    if (!command.has(letter)) return current;
    if (!command.hasValue(letter)) refuse(fmt::format("{} has no number; expected e.g. {}10.5", letter, letter));
    const double value = command.value(letter) * unit_;
    const double target = absolute_ ? value + offset : current + value;
    if (!(std::abs(target) <= kMaxCoordinate))
        refuse(fmt::format("{}{} is no place on a printer (limit {} mm); is the file damaged?", letter,
                           command.value(letter), kMaxCoordinate));
    return target;
}

double Machine::takeExtrusion(const Command& command) {
    if (!command.has('E')) return 0;
    if (!command.hasValue('E')) refuse("E has no number; expected e.g. E0.5");
    if (!e_mode_known_) assumeExtruderMode();
    const double value = command.value('E') * eUnit();
    const double extrusion = e_absolute_ ? value - e_ : value;
    if (!(std::abs(extrusion) <= kMaxExtrusion))
        refuse(fmt::format("E{} is no extrusion (limit {} in one move); is the file damaged?", command.value('E'),
                           kMaxExtrusion));
    e_ = e_absolute_ ? value : e_ + value;
    return extrusion;
}

void Machine::assumeExtruderMode() {
    // No M82 or M83 before the first extrusion: a start macro of the printer may hold it. The slicer's settings know.
    e_mode_known_ = true;
    if (settings_.relative_e)
        e_absolute_ = !*settings_.relative_e;
    else if (!e_follows_axes_)
        warn("neither M82 nor M83 before the first extrusion; E is taken as absolute (--e-mode relative if not)");
}

void Machine::move(const Command& command, int motion) {
    if (command.hasValue('F') && command.value('F') > 0) recorder_.setSpeed(command.value('F') * unit_ / 60);
    const Point target{takeAxis(command, 'X', position_.x, offset_.x), takeAxis(command, 'Y', position_.y, offset_.y),
                       takeAxis(command, 'Z', position_.z, offset_.z)};
    const double drive = takeExtrusion(command);
    const bool in_place = target.x == position_.x && target.y == position_.y && motion < 2;
    const double extrusion = drive != 0 ? leavesNozzle(drive, in_place) : 0;
    if (extrusion > 0) {
        std::optional<Arc> arc;
        if (motion >= 2) arc = arcOf(command, target, motion == 2);
        double plan = std::hypot(target.x - position_.x, target.y - position_.y);
        if (arc) {
            const double radius = 0.5 * (std::hypot(position_.x - arc->center_x, position_.y - arc->center_y) +
                                         std::hypot(target.x - arc->center_x, target.y - arc->center_y));
            plan = radius * std::abs(arc->sweep);
        }
        if (plan > kNoMotion)
            deposit(target, arc, std::hypot(plan, target.z - position_.z), extrusion);
        else
            ++counts_.stationary;
    } else {
        ++counts_.travels;
    }
    position_ = target;
}

double Machine::leavesNozzle(double drive, bool in_place) {
    // Multi-material units swap filament while the head travels over the wipe tower (PrusaSlicer's "CP TOOLCHANGE"):
    // metres of E that only fetch the filament back. Ordinary retractions are taken at the file's word.
    const double mm = volumetric_ ? drive / filamentArea() : drive;
    const std::size_t nozzle = settings_.shared_nozzle ? 0 : tool_;
    double& drawn_back = drawn_back_[nozzle];
    bool& unloaded = unloaded_[nozzle];
    if (drive < 0) {
        drawn_back -= mm;
        if (drawn_back > kUnloaded) unloaded = true;
        return drive;
    }
    if (!unloaded) {
        drawn_back = in_place ? std::max(0.0, drawn_back - mm) : 0;
        return drive;
    }
    const double fetched = std::min(drawn_back, mm);
    drawn_back -= fetched;
    unloaded = drawn_back > 0;
    return drive * (1 - fetched / mm);
}

std::optional<Arc> Machine::arcOf(const Command& command, const Point& target, bool clockwise) {
    for (const char letter : {'I', 'J', 'R'}) {
        if (!command.has(letter)) continue;
        if (!command.hasValue(letter)) refuse(fmt::format("{} has no number; expected e.g. {}10.5", letter, letter));
        if (!(std::abs(command.value(letter) * unit_) <= kMaxCoordinate))
            refuse(fmt::format("{}{} is no arc on a printer (limit {} mm); is the file damaged?", letter,
                               command.value(letter), kMaxCoordinate));
    }
    const PlanPoint start{position_.x, position_.y};
    const PlanPoint end{target.x, target.y};
    std::optional<Arc> arc;
    if (command.has('R')) {
        arc = arcFromRadius(start, end, command.value('R') * unit_, clockwise);
    } else {
        const double i = command.has('I') ? command.value('I') * unit_ : 0;
        const double j = command.has('J') ? command.value('J') * unit_ : 0;
        arc = arcFromOffset(start, end, {i, j}, clockwise);
    }
    if (!arc) warn("arc whose centre, radius and end don't agree; drawn as a straight line");
    return arc;
}

void Machine::deposit(const Point& target, const std::optional<Arc>& arc, double length, double extrusion) {
    const double volume = volumetric_ ? extrusion : extrusion * filamentArea();
    filament_mm_ += volumetric_ ? extrusion / filamentArea() : extrusion;
    ++counts_.beads;
    const double flow = flow_[tool_];
    if (!(flow > 0)) return;
    extruded_mm3_ += volume * flow;
    recorder_.add(position_, target, arc, length, volume * flow, line_);
}

void Machine::home(const Command& command) {
    const bool all = !command.has('X') && !command.has('Y') && !command.has('Z');
    if (all || command.has('X')) position_.x = offset_.x = 0;
    if (all || command.has('Y')) position_.y = offset_.y = 0;
    if (all || command.has('Z')) position_.z = offset_.z = 0;
}

void Machine::setPosition(const Command& command) {
    if (command.subcode != 0) {  // G92.1 and up drop or keep the offsets of earlier G92s
        if (command.subcode == 1) offset_ = {};
        return;
    }
    const bool bare = !command.has('X') && !command.has('Y') && !command.has('Z') && !command.has('E');
    const auto set = [&](char letter, double& position, double& offset) {
        if (!bare && !command.has(letter)) return;
        // As in Marlin, an axis without a number is set to 0.
        const double value = command.hasValue(letter) ? command.value(letter) * unit_ : 0;
        if (!(std::abs(value) <= kMaxCoordinate))
            refuse(fmt::format("{}{} is no place on a printer (limit {} mm); is the file damaged?", letter,
                               command.value(letter), kMaxCoordinate));
        if (counts_.beads > 0)
            offset = position - value;
        else
            position = value;
    };
    set('X', position_.x, offset_.x);
    set('Y', position_.y, offset_.y);
    set('Z', position_.z, offset_.z);
    if (!bare && !command.has('E')) return;
    const double value = command.hasValue('E') ? command.value('E') * eUnit() : 0;
    if (!std::isfinite(value)) refuse("the E of this G92 is no number; is the file damaged?");
    e_ = value;
}

void Machine::setAbsolute(bool absolute) {
    absolute_ = absolute;
    if (firmware_ != Firmware::marlin) return;
    // Marlin 2 lets G90 undo M83, Marlin 1 did not; slicers that set relative E count on the latter and send G90 after.
    if (absolute && settings_.relative_e.value_or(false)) return;
    e_absolute_ = absolute;
    e_follows_axes_ = true;
}

void Machine::setVolumetric(const Command& command) {
    if (command.hasValue('S') && !command.has('D')) volumetric_ = command.value('S') > 0;  // Marlin 2's switch
    if (!command.hasValue('D')) return;
    const double diameter = command.value('D') * unit_;
    if (!(diameter >= 0 && diameter <= kMaxFilament))
        refuse(fmt::format("M200 D{} is no filament diameter in mm", command.value('D')));
    volumetric_ = diameter > 0;
    if (volumetric_) m200_diameter_ = diameter;
}

void Machine::setFlow(const Command& command) {
    if (!command.hasValue('S')) return;
    const double percent = command.value('S');
    if (!(percent >= 0 && percent <= kMaxFlow)) refuse(fmt::format("M221 S{} is no flow in per cent", percent));
    std::size_t tool = tool_;
    for (const char letter : {'T', 'D'})  // Marlin, RepRapFirmware
        if (command.hasValue(letter) && command.value(letter) >= 0 && command.value(letter) < 255)
            tool = static_cast<std::size_t>(command.value(letter));
    flow_[tool] = percent / 100;
}

void Machine::labelObject(const Command& command) {
    if (objects_by_comment_ || !command.hasValue('S')) return;
    const double number = command.value('S');
    if (number < 0 || number > 65535) return recorder_.stopObject();
    recorder_.startObject(fmt::format("object {}", static_cast<int>(number)), line_);
}

double Machine::filamentDiameter(std::size_t tool) const {
    if (filament_override_) return *filament_override_;
    const auto& list = settings_.filament_diameters;
    if (!list.empty()) return list[std::min(tool, list.size() - 1)];
    return m200_diameter_.value_or(1.75);
}

double Machine::filamentArea() const {
    const double diameter = filamentDiameter(tool_);
    return std::numbers::pi / 4 * diameter * diameter;
}

}  // namespace stratum::gcode
