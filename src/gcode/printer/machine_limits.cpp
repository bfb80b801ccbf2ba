#include "gcode/printer/machine_limits.h"

#include "gcode/text/setting_text.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>

namespace stratum::gcode {
namespace {

constexpr std::array<std::string_view, kMotionAxes> kAxisNames{"x", "y", "z", "e"};

// The first of a list is the normal mode's.
std::optional<double> number(std::string_view text, double least, double most) {
    const auto cut = std::min(text.find(','), text.size());
    const std::vector<double> values = numbersOf(text.substr(0, cut), least, most);
    return values.empty() ? std::nullopt : std::optional<double>(values.front());
}

std::optional<double> number(std::string_view text, Limit limit) {
    const Bounds bounds = boundsOf(limit);
    return number(text, bounds.least, bounds.most);
}

// What most of Klipper's sample configurations have; the last two by its formula for a nozzle of 0.4 mm and filament of
// 1.75 mm: 4 nozzle^2 / section of the filament, times the limit of the path.
struct KlipperSample {
    double max_velocity = 300;      // mm/s
    double max_accel = 3000;        // mm/s^2
    double max_z_velocity = 5;      // mm/s
    double max_z_accel = 100;       // mm/s^2
    double extrude_ratio = 0.2661;  // of the path's limits, for moves of E alone
};

class LimitsReader {
public:
    LimitsReader(const std::optional<PrinterLimits>& printer, Firmware firmware, const SlicerLimits& slicer)
        : printer_(printer),
          slicer_(slicer),
          klipper_(firmware == Firmware::klipper),
          reprap_(firmware == Firmware::reprap) {}

    void comment(std::string_view text) {
        text = trimQuoted(text);
        const auto setting = keyAndValue(text);
        if (setting && setting->first.find(' ') == std::string_view::npos) pair(setting->first, setting->second);
    }

    MachineSettings finish(CornerRule rule) {
        MachineLimits& limits = settings_.limits;
        if (isPlannedBySlicer()) takeSlicersLimits();
        // Legacy Marlin has one acceleration for printing and travel.
        if (flavor_ == "marlin") copy(Limit::printing, Limit::travel);
        settings_.most_printing = most_printing_;
        settings_.most_travel = flavor_ == "marlin" ? most_printing_ : most_travel_;
        settings_.feedrate_per_minute =
            reprap_ || rule == CornerRule::reprap_jerk || flavor_ == "reprap" || flavor_ == "reprapfirmware";
        settings_.rule_chosen = rule != CornerRule::automatic || printersRule() != CornerRule::automatic;
        limits.rule = rule != CornerRule::automatic ? rule : suggestedRule();
        if (swaps_heads_) {  // as PrusaSlicer's GCodeProcessor has it, whatever the filaments' settings
            settings_.load = {4.5};
            settings_.unload.clear();
        }
        if (printer_) usePrinter();
        if (limits.rule == CornerRule::corner_velocity) assumeKlipper();
        for (std::size_t n = 0; n < kLimitCount; ++n)
            settings_.origins[static_cast<Limit>(n)].value = valueOf(limits, static_cast<Limit>(n));
        return settings_;
    }

private:
    CornerRule printersRule() const { return printer_ ? printer_->limits.rule : CornerRule::automatic; }

    CornerRule suggestedRule() const {
        if (printersRule() != CornerRule::automatic) return printersRule();
        if (klipper_ || flavor_ == "klipper") return CornerRule::corner_velocity;
        if (isPlannedBySlicer()) return slicer_.limits->rule;
        if (deviation_) return CornerRule::junction_deviation;
        if (!settings_.states_jerk) return CornerRule::jerk;
        return slicer_.by_velocity ? CornerRule::bambu_jerk : CornerRule::slicer_jerk;
    }

    bool isStated(Limit limit) const { return settings_.origins[limit].kind != LimitOrigin::Kind::assumed; }

    static bool isGiven(const LimitOrigin& origin) {
        return origin.kind == LimitOrigin::Kind::printer || origin.kind == LimitOrigin::Kind::firmware;
    }

    void copy(Limit from, Limit to) {
        if (isGiven(settings_.origins[to])) return;
        valueOf(settings_.limits, to) = valueOf(settings_.limits, from);
        settings_.origins[to] = settings_.origins[from];
    }

    void assume(Limit limit, double value) {
        if (isGiven(settings_.origins[limit])) return;
        valueOf(settings_.limits, limit) = value;
        settings_.origins[limit] = {};
    }

    // The same limit under Klipper's name, of whatever setting is like it; what the user gives stays.
    void assumeKlipper() {
        const KlipperSample sample;
        MachineLimits& limits = settings_.limits;
        settings_.most_printing = settings_.most_travel = 0;
        const auto weaker = [&](Limit first) {
            return valueOf(limits, ofAxis(first, 1)) < valueOf(limits, first) ? ofAxis(first, 1) : first;
        };
        if (const Limit speed = weaker(Limit::speed); isStated(speed))
            copy(speed, Limit::path_speed);
        else
            assume(Limit::path_speed, sample.max_velocity);
        if (const Limit acceleration = weaker(Limit::acceleration); !isStated(Limit::printing)) {
            if (isStated(acceleration))
                copy(acceleration, Limit::printing);
            else
                assume(Limit::printing, sample.max_accel);
        }
        copy(Limit::printing, Limit::travel);
        if (!isStated(ofAxis(Limit::speed, 2))) assume(ofAxis(Limit::speed, 2), sample.max_z_velocity);
        if (!isStated(ofAxis(Limit::acceleration, 2))) assume(ofAxis(Limit::acceleration, 2), sample.max_z_accel);
        if (const Limit speed = ofAxis(Limit::speed, 3); isStated(speed))
            copy(speed, Limit::extrude_only_speed);
        else
            assume(Limit::extrude_only_speed, sample.extrude_ratio * limits.path_speed);
        if (const Limit acceleration = ofAxis(Limit::acceleration, 3); isStated(acceleration))
            copy(acceleration, Limit::retracting);
        else
            assume(Limit::retracting, sample.extrude_ratio * limits.printing);
        for (const std::size_t axis : {std::size_t{0}, std::size_t{1}, std::size_t{3}})
            limits.speed[axis] = limits.acceleration[axis] = MachineLimits::kNone;
        limits.least_printing_speed = limits.least_travel_speed = 0;
        limits.arcs = ArcRule::klipper;
    }

    void usePrinter() {
        const PrinterLimits& printer = *printer_;
        for (std::size_t n = 0; n < kLimitCount; ++n) {
            const auto limit = static_cast<Limit>(n);
            if (!isGiven(printer.origins[limit])) continue;
            valueOf(settings_.limits, limit) = valueOf(printer.limits, limit);
            settings_.origins[limit] = printer.origins[limit];
            if (limit == Limit::printing) settings_.most_printing = 0;
            if (limit == Limit::travel) settings_.most_travel = 0;
        }
        if (printer.limits.pressure_advance > 0) settings_.limits.pressure_advance = printer.limits.pressure_advance;
        if (printer.limits.arcs != ArcRule::unknown) settings_.limits.arcs = printer.limits.arcs;
        settings_.limits.jerk_policy = printer.limits.jerk_policy;
        if (printer.firmware != Firmware::automatic) settings_.feedrate_per_minute = reprap_;
    }

    void pair(std::string_view key, std::string_view value) {
        if (key == "gcode_flavor") {
            flavor_ = value;
        } else if (key.starts_with("machine_max_")) {
            limit(key, key.substr(std::string_view("machine_max_").size()), value);
        } else if (key == "machine_min_extruding_rate") {
            set(Limit::least_printing_speed, key, value);
        } else if (key == "machine_min_travel_rate") {
            set(Limit::least_travel_speed, key, value);
        } else if (key == "xy_accel_mm_per_s_per_s") {  // KISSlicer's; its z_speed is what it asks for, no limit
            for (const Limit limit : {Limit::printing, Limit::travel}) set(limit, key, value);
        } else if (key == "printer_notes") {
            swaps_heads_ = value.find("PRINTER_VENDOR_PRUSA3D") != std::string_view::npos &&
                           value.find("PRINTER_MODEL_XL") != std::string_view::npos;
        } else if (key == "filament_load_time") {
            settings_.load = numbersOf(value, 0, kLongestWait);
        } else if (key == "filament_unload_time") {
            settings_.unload = numbersOf(value, 0, kLongestWait);
            settings_.parked = true;
        } else if (key == "machine_load_filament_time") {
            if (const auto time = number(value, 0, kLongestWait)) settings_.load = {*time};
        } else if (key == "machine_unload_filament_time") {
            if (const auto time = number(value, 0, kLongestWait)) settings_.unload = {*time};
        } else if (key == "machine_tool_change_time") {
            if (const auto time = number(value, 0, kLongestWait)) settings_.change = *time;
        } else if (key == "machine_switch_extruder_time") {  // Bambu Studio's name of it, of printers with several
            if (const auto time = number(value, 0, kLongestWait)) settings_.extruder_change = *time;
        } else if (key == "filament_map") {
            mapFilaments(value);
        }
    }

    void mapFilaments(std::string_view value) {
        const std::vector<double> extruders = numbersOf(value, 1, 16);
        if (extruders.empty() || std::ranges::count(extruders, extruders.front()) == std::ssize(extruders)) return;
        settings_.extruders.assign(extruders.begin(), extruders.end());
    }

    void limit(std::string_view key, std::string_view kind, std::string_view value) {
        if (kind == "acceleration_extruding") {
            set(Limit::printing, key, value);
            if (const auto most = number(value, Limit::printing); most && !ignoresSettings()) most_printing_ = *most;
        } else if (kind == "acceleration_retracting") {
            set(Limit::retracting, key, value);
        } else if (kind == "acceleration_travel") {
            set(Limit::travel, key, value);
            if (const auto most = number(value, Limit::travel); most && !ignoresSettings()) most_travel_ = *most;
        } else if (kind == "junction_deviation") {
            deviation_ = number(value, Limit::junction_deviation).has_value();
            set(Limit::junction_deviation, key, value);
        } else {
            byAxis(key, kind, value);
        }
    }

    void byAxis(std::string_view key, std::string_view kind, std::string_view value) {
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
            if (!kind.ends_with(kAxisNames[axis])) continue;
            const std::string_view what = kind.substr(0, kind.size() - 1);
            if (what == "feedrate_" || what == "speed_") {
                set(ofAxis(Limit::speed, axis), key, value);
            } else if (what == "acceleration_") {
                set(ofAxis(Limit::acceleration, axis), key, value);
            } else if (what == "jerk_") {
                set(ofAxis(Limit::jerk, axis), key, value);
                settings_.states_jerk = true;
            }
        }
    }

    bool ignoresSettings() const { return slicer_.ignores_settings && !printer_; }

    bool isPlannedBySlicer() const { return slicer_.limits && !printer_; }

    // Of a machine that the file doesn't name they are an assumption.
    void takeSlicersLimits() {
        for (std::size_t n = 0; n < kLimitCount; ++n) {
            const auto limit = static_cast<Limit>(n);
            valueOf(settings_.limits, limit) = valueOf(*slicer_.limits, limit);
            settings_.origins[limit] = {};
            if (!slicer_.machine.empty())
                settings_.origins[limit] = {.kind = LimitOrigin::Kind::setting, .place = slicer_.machine};
        }
        settings_.states_jerk = true;
        settings_.limits.guessed = slicer_.limits->guessed;
    }

    void set(Limit limit, std::string_view key, std::string_view text) {
        if (ignoresSettings()) return;
        const auto value = number(text, limit);
        if (!value) return;
        valueOf(settings_.limits, limit) = *value;
        settings_.origins[limit] = {.kind = LimitOrigin::Kind::setting, .place = std::string(key)};
    }

    MachineSettings settings_;
    const std::optional<PrinterLimits>& printer_;
    std::string_view flavor_;
    double most_printing_ = 0;
    double most_travel_ = 0;
    bool deviation_ = false;
    bool swaps_heads_ = false;  // it is Prusa's XL
    const SlicerLimits& slicer_;
    const bool klipper_;
    const bool reprap_;
};

}  // namespace

MachineSettings readMachineSettings(std::string_view bytes, CornerRule rule,
                                    const std::optional<PrinterLimits>& printer, Firmware firmware,
                                    const SlicerLimits& slicer) {
    LimitsReader reader(printer, firmware, slicer);
    forEachSettingsComment(bytes, [&reader](char mark, std::string_view text) {
        if (mark == ';') reader.comment(text);
    });
    return reader.finish(rule);
}

}  // namespace stratum::gcode
