// Klipper's named commands: frame offsets, saved states, object labels, and others.
#include "base/text.h"
#include "gcode/machine/machine.h"
#include "gcode/text/known_commands.h"
#include "gcode/text/limits.h"
#include "gcode/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace stratum::gcode {
namespace {

bool same(std::string_view text, std::string_view upper_case) {
    return std::equal(text.begin(), text.end(), upper_case.begin(), upper_case.end(),
                      [](char a, char b) { return upperCase(a) == b; });
}

// The value of "KEY=" in the arguments, without quotes; nullopt if there is none. `key` is upper case.
std::optional<std::string_view> argument(std::string_view text, std::string_view key) {
    while (!text.empty()) {
        const auto start = std::min(text.find_first_not_of(" \t"), text.size());
        text.remove_prefix(start);
        const auto equals = text.find('=');
        if (equals == std::string_view::npos) return std::nullopt;
        const std::string_view name = text.substr(0, equals);
        text.remove_prefix(equals + 1);
        const char quote = text.empty() ? '\0' : text.front();
        std::size_t end = 0;
        if (quote == '"' || quote == '\'') {
            text.remove_prefix(1);
            end = std::min(text.find(quote), text.size());
        } else {
            end = std::min(text.find_first_of(" \t"), text.size());
        }
        if (same(name, key)) return text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return std::nullopt;
}

std::optional<double> numberArgument(std::string_view text, std::string_view key) {
    const auto value = argument(text, key);
    if (!value) return std::nullopt;
    const char* p = value->data();
    double number = 0;
    if (!parseNumber(p, p + value->size(), number) || !(std::abs(number) <= kMaxCoordinate)) return std::nullopt;
    return number;
}

// 12 of "extruder12", 0 of "extruder"; no more than a tool can be.
std::size_t trailingNumber(std::string_view text) {
    std::size_t number = 0;
    for (const char c : text.substr(text.find_last_not_of("0123456789") + 1))
        number = std::min<std::size_t>(number * 10 + static_cast<std::size_t>(c - '0'), 254);
    return number;
}

// RepRapFirmware's meta commands that only set and write (docs.duet3d.com, "GCode Meta Commands").
bool isStatement(std::string_view name) {
    constexpr std::array<std::string_view, 4> kStatements{"SET", "VAR", "GLOBAL", "ECHO"};
    return std::any_of(kStatements.begin(), kStatements.end(),
                       [name](std::string_view one) { return same(name, one); });
}

// Prose that has lost its ';': a macro's arguments have a '='.
bool isProse(std::string_view text) {
    if (text.find('=') != std::string_view::npos) return false;
    constexpr std::size_t kFewest = 2;  // words
    const auto isWord = [](std::string_view part) {
        return part.size() > 1 && std::all_of(part.begin(), part.end(), [](char c) { return isLetter(c); });
    };
    const std::vector<std::string_view> parts = split(text, ' ');
    return static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(), isWord)) >= kFewest;
}

}  // namespace

void Machine::executeMacro(const Command& command) {
    const std::string_view name = command.name;
    if (same(name, "EXCLUDE_OBJECT_START")) {
        const auto object = argument(command.text, "NAME");
        if (object && !objects_by_comment_) recorder_.startObject(*object, line_);
    } else if (same(name, "EXCLUDE_OBJECT_END")) {
        if (!objects_by_comment_) recorder_.stopObject();
    } else if (same(name, "SET_GCODE_OFFSET")) {
        setMacroOffset(command.text);
    } else if (same(name, "SAVE_GCODE_STATE")) {
        saveState(command.text);
    } else if (same(name, "RESTORE_GCODE_STATE")) {
        restoreState(command.text);
    } else if (same(name, "ACTIVATE_EXTRUDER")) {
        // "extruder" is the first, "extruder1" the second.
        useTool(trailingNumber(argument(command.text, "EXTRUDER").value_or("")));
    } else if (same(name, "SELECT_TOOL") || same(name, "MMU_CHANGE_TOOL")) {
        // klipper-toolchanger, Happy Hare
        const auto tool = numberArgument(command.text, "T");
        useNumberedTool(tool ? *tool : numberArgument(command.text, "TOOL").value_or(-1));
    } else if (same(name, "SET_DUAL_CARRIAGE")) {
        carriages_.setMode(argument(command.text, "MODE").value_or(""), line_);
    } else if (same(name, "SET_HEATER_TEMPERATURE")) {
        const std::string_view heater = argument(command.text, "HEATER").value_or("");
        if (heater.starts_with("extruder"))
            recorder_.heat(static_cast<double>(trailingNumber(heater)),
                           numberArgument(command.text, "TARGET").value_or(0), line_);
    } else if (same(name, "SYNC")) {  // Bambu's: "SYNC T10"
        std::string_view text = command.text;
        text.remove_prefix(std::min(text.find_first_of("Tt"), text.size()));
        const char* p = text.data() + std::min<std::size_t>(1, text.size());
        double seconds = 0;
        if (moves_ != nullptr && parseNumber(p, text.data() + text.size(), seconds)) moves_->wait(seconds);
    } else if (moves_ != nullptr && same(name, "PAUSE")) {
        moves_->pause(line_);
    } else if (same(name, "SET_VELOCITY_LIMIT")) {
        setVelocityLimit(command.text);
    } else if (moves_ != nullptr && same(name, "SET_RETRACTION")) {
        moves_->retraction({.length = numberArgument(command.text, "RETRACT_LENGTH"),
                            .speed = numberArgument(command.text, "RETRACT_SPEED"),
                            .extra = numberArgument(command.text, "UNRETRACT_EXTRA_LENGTH"),
                            .recovery_speed = numberArgument(command.text, "UNRETRACT_SPEED")});
    } else if (same(name, "SET_PRESSURE_ADVANCE")) {
        setPressureAdvance(command.text);
    } else if (isProse(command.text) && !isStatement(name)) {
        warnNoWords();
    } else if (!isHarmlessMacro(name) && !isStatement(name)) {
        warn(fmt::format("macro {} is not in the file; what it prints or moves is not in the toolpath",
                         name.substr(0, 60)));
    }
}

void Machine::setPressureAdvance(std::string_view text) {
    const auto advance = numberArgument(text, "ADVANCE");
    if (!advance) return;
    const auto extruder = argument(text, "EXTRUDER");  // "extruder" is the first
    recorder_.advance(static_cast<double>(extruder ? trailingNumber(*extruder) : tool_), *advance, line_);
    if (moves_ != nullptr) moves_->pressureAdvance("SET_PRESSURE_ADVANCE ADVANCE=", *advance, line_);
}

void Machine::setVelocityLimit(std::string_view text) {
    const auto acceleration = numberArgument(text, "ACCEL");
    if (acceleration) recorder_.accelerate(*acceleration, line_);
    if (moves_ == nullptr) return;
    moves_->velocityLimit({.velocity = numberArgument(text, "VELOCITY"),
                           .acceleration = acceleration,
                           .cruise_ratio = numberArgument(text, "MINIMUM_CRUISE_RATIO"),
                           .corner_velocity = numberArgument(text, "SQUARE_CORNER_VELOCITY")},
                          line_);
}

void Machine::setMacroOffset(std::string_view text) {
    constexpr std::array<std::string_view, 3> kAbsolute{"X", "Y", "Z"};
    constexpr std::array<std::string_view, 3> kRelative{"X_ADJUST", "Y_ADJUST", "Z_ADJUST"};
    // Behind a change of tool it is that nozzle's place, which its program's coordinates are to be free of, as with
    // M218.
    const std::size_t beads = recorder_.toolpath().beads.size();
    if (beads > 0 && beads == beads_at_tool_) {
        warn("SET_GCODE_OFFSET behind a change of tool tells where that nozzle is; ignored, as M218 is");
        return;
    }
    const bool moves = numberArgument(text, "MOVE").value_or(0) != 0;
    Point target = frame_.position();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double shift = frame_.homeOffset(axis);
        if (const auto value = numberArgument(text, kAbsolute[axis]))
            shift = -*value;
        else if (const auto change = numberArgument(text, kRelative[axis]))
            shift -= *change;
        const double program = frame_.program(axis);
        frame_.setHomeOffset(axis, shift);
        // With MOVE the nozzle moves, and the program's coordinate stays; otherwise the nozzle stays.
        target[axis] = moves ? program + frame_.offset()[axis] : frame_.position()[axis];
    }
    recordReturn(target, numberArgument(text, "MOVE_SPEED"));
    frame_.moveTo(target);
}

void Machine::recordReturn(const Point& target, std::optional<double> speed) {
    if (moves_ == nullptr) return;
    moves_->move(frame_.position(), target, std::nullopt, 0, filamentArea(), speed.value_or(feed_ * speed_factor_),
                 Move::kNoBead, line_);
}

void Machine::saveState(std::string_view text) {
    constexpr std::size_t kMostStates = 100;
    const std::string name(argument(text, "NAME").value_or("default"));
    if (saved_.size() >= kMostStates && !saved_.contains(name)) return warn("more saved states than are kept");
    saved_.insert_or_assign(name, Saved{.frame = frame_,
                                        .e = e_,
                                        .feed = feed_,
                                        .speed_factor = speed_factor_,
                                        .flow = flow_,
                                        .absolute = absolute_,
                                        .e_absolute = e_absolute_});
}

void Machine::restoreState(std::string_view text) {
    const auto found = saved_.find(argument(text, "NAME").value_or("default"));
    if (found == saved_.end()) return warn("RESTORE_GCODE_STATE of a state that was never saved; ignored");
    const Saved& saved = found->second;
    absolute_ = saved.absolute;
    e_absolute_ = saved.e_absolute;
    e_ = saved.e;
    flow_ = saved.flow;
    feed_ = saved.feed;
    speed_factor_ = saved.speed_factor;
    recorder_.setSpeed(feed_ * speed_factor_);
    frame_.restoreOffsets(saved.frame);
    if (numberArgument(text, "MOVE").value_or(0) == 0) return;
    Point target;
    for (std::size_t axis = 0; axis < 3; ++axis) target[axis] = saved.frame.program(axis) + frame_.offset()[axis];
    recordReturn(target, numberArgument(text, "MOVE_SPEED"));
    frame_.moveTo(target);
}

}  // namespace stratum::gcode
