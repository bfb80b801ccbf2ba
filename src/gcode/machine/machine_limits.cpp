#include "gcode/machine/machine_limits.h"

#include "gcode/text/setting_text.h"

#include <algorithm>
#include <array>
#include <optional>

namespace stratum::gcode {
namespace {

constexpr std::size_t kReach = std::size_t{1} << 18;  // as of the other settings
constexpr std::array<std::string_view, kMotionAxes> kAxisNames{"x", "y", "z", "e"};

// The first of a list is the normal mode's.
std::optional<double> number(std::string_view text, double least, double most) {
    const auto cut = std::min(text.find(','), text.size());
    const std::vector<double> values = numbersOf(text.substr(0, cut), least, most);
    return values.empty() ? std::nullopt : std::optional<double>(values.front());
}

void take(double& target, std::string_view text, double least, double most) {
    if (const auto value = number(text, least, most)) target = *value;
}

class LimitsReader {
public:
    explicit LimitsReader(const std::optional<MachineLimits>& defaults) : given_(defaults.has_value()) {
        if (defaults) settings_.limits = *defaults;
    }

    void comment(std::string_view text) {
        text = trimQuoted(text);
        const auto setting = keyAndValue(text);
        if (setting && setting->first.find(' ') == std::string_view::npos)
            pair(setting->first, setting->second);
        else if (text.starts_with("Generated with Cura"))
            cura_ = true;
    }

    MachineSettings finish(CornerRule rule) {
        MachineLimits& limits = settings_.limits;
        if (cura_ && !any_limit_ && !given_) {
            // fdmprinter.def.json, for a machine that says nothing else.
            limits.speed = {500, 500, 500, 500};
            limits.acceleration = {9000, 9000, 100, 10000};
            limits.jerk = {20, 20, 0.4, 5};
            limits.printing = limits.retracting = limits.travel = 4000;
        }
        // Legacy Marlin has one acceleration for printing and travel.
        if (flavor_ == "marlin") limits.travel = limits.printing;
        settings_.most_printing = most_printing_;
        settings_.most_travel = flavor_ == "marlin" ? most_printing_ : most_travel_;
        settings_.feedrate_per_minute = flavor_ == "reprap" || flavor_ == "reprapfirmware";
        settings_.rule_chosen = rule != CornerRule::automatic;
        limits.rule = settings_.rule_chosen ? rule : suggestedRule();
        return settings_;
    }

private:
    CornerRule suggestedRule() const {
        if (cura_ && !any_limit_ && !given_) return CornerRule::plan_jerk;
        if (deviation_) return CornerRule::junction_deviation;
        if (flavor_ == "klipper" && !settings_.states_jerk) return CornerRule::corner_velocity;
        return settings_.states_jerk ? CornerRule::slicer_jerk : CornerRule::jerk;
    }

    void pair(std::string_view key, std::string_view value) {
        if (key == "gcode_flavor") {
            flavor_ = value;
        } else if (key.starts_with("machine_max_")) {
            limit(key.substr(std::string_view("machine_max_").size()), value);
        } else if (key == "machine_min_extruding_rate") {
            take(settings_.limits.least_printing_speed, value, 0, kFastestAxis);
        } else if (key == "machine_min_travel_rate") {
            take(settings_.limits.least_travel_speed, value, 0, kFastestAxis);
        } else if (key == "filament_load_time") {
            settings_.load = numbersOf(value, 0, kLongestWait);
        } else if (key == "filament_unload_time") {
            settings_.unload = numbersOf(value, 0, kLongestWait);
        } else if (key == "machine_load_filament_time") {
            if (const auto time = number(value, 0, kLongestWait)) settings_.load = {*time};
        } else if (key == "machine_unload_filament_time") {
            if (const auto time = number(value, 0, kLongestWait)) settings_.unload = {*time};
        } else if (key == "machine_tool_change_time") {
            take(settings_.change, value, 0, kLongestWait);
        }
    }

    void limit(std::string_view key, std::string_view value) {
        MachineLimits& limits = settings_.limits;
        if (key == "acceleration_extruding") {
            take(limits.printing, value, kWeakestAxis, kStrongestAxis);
            take(most_printing_, value, kWeakestAxis, kStrongestAxis);
        } else if (key == "acceleration_retracting") {
            take(limits.retracting, value, kWeakestAxis, kStrongestAxis);
        } else if (key == "acceleration_travel") {
            take(limits.travel, value, kWeakestAxis, kStrongestAxis);
            take(most_travel_, value, kWeakestAxis, kStrongestAxis);
        } else if (key == "junction_deviation") {
            const auto deviation = number(value, 0, kLongestDeviation);
            deviation_ = deviation.value_or(0) > 0;
            if (deviation_) limits.junction_deviation = *deviation;
        } else {
            byAxis(key, value);
        }
        any_limit_ = true;
    }

    void byAxis(std::string_view key, std::string_view value) {
        MachineLimits& limits = settings_.limits;
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
            if (!key.ends_with(kAxisNames[axis])) continue;
            const std::string_view kind = key.substr(0, key.size() - 1);
            if (kind == "feedrate_" || kind == "speed_") {
                take(limits.speed[axis], value, 1e-3, kFastestAxis);
            } else if (kind == "acceleration_") {
                take(limits.acceleration[axis], value, kWeakestAxis, kStrongestAxis);
            } else if (kind == "jerk_") {
                take(limits.jerk[axis], value, 0, kFastestAxis);
                settings_.states_jerk = true;
            }
        }
    }

    MachineSettings settings_;
    std::string_view flavor_;
    double most_printing_ = 0;
    double most_travel_ = 0;
    bool deviation_ = false;
    bool any_limit_ = false;
    bool cura_ = false;
    const bool given_;
};

void readComments(std::string_view part, LimitsReader& reader) {
    while (!part.empty()) {
        const auto end = std::min(part.find_first_of("\r\n"), part.size());
        if (part.front() == ';') reader.comment(part.substr(1, end - 1));
        part.remove_prefix(std::min(end + 1, part.size()));
    }
}

}  // namespace

MachineSettings readMachineSettings(std::string_view bytes, CornerRule rule,
                                    const std::optional<MachineLimits>& defaults) {
    LimitsReader reader(defaults);
    readComments(bytes.substr(0, kReach), reader);
    if (bytes.size() > kReach) {
        std::string_view tail = bytes.substr(std::max(kReach, bytes.size() - kReach));
        tail.remove_prefix(std::min(tail.find_first_of("\r\n"), tail.size()));
        readComments(tail, reader);
    }
    return reader.finish(rule);
}

}  // namespace stratum::gcode
