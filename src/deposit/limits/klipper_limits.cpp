#include "deposit/limits/klipper_limits.h"

#include "base/error.h"
#include "deposit/limits/klipper_config.h"
#include "deposit/limits/printer_text.h"
#include "gcode/machine/machine_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace stratum::deposit {
namespace {

using gcode::Bounds;
using gcode::Limit;
using gcode::LimitOrigin;
using gcode::ofAxis;
using Value = KlipperConfig::Value;

constexpr Limit kSpeedZ = ofAxis(Limit::speed, 2);
constexpr Limit kAccelerationZ = ofAxis(Limit::acceleration, 2);
constexpr Bounds kNozzle{0.01, 10};    // mm
constexpr Bounds kFilament{0.1, 100};  // mm

class KlipperLimits {
public:
    KlipperLimits(const std::string& path, std::string_view text) : path_(path), config_(path, text) {
        limits_.name = path;
        limits_.firmware = gcode::Firmware::klipper;
        limits_.limits.rule = gcode::CornerRule::corner_velocity;
        limits_.limits.arcs = gcode::ArcRule::klipper;
    }

    gcode::PrinterLimits read() {
        need("printer", "max_velocity", Limit::path_speed);
        need("printer", "max_accel", Limit::printing);
        limits_.set(Limit::travel, limits_.limits.printing, LimitOrigin::Kind::printer,
                    limits_.origins[Limit::printing].place);
        take("printer", "square_corner_velocity", Limit::corner_velocity, 5);
        readCruiseRatio();
        take("printer", "max_z_velocity", kSpeedZ, limits_.limits.path_speed);
        take("printer", "max_z_accel", kAccelerationZ, limits_.limits.printing);
        refuseAbove("max_z_velocity", kSpeedZ, "max_velocity", Limit::path_speed);
        refuseAbove("max_z_accel", kAccelerationZ, "max_accel", Limit::printing);
        take("gcode_arcs", "resolution", Limit::arc_resolution, 1);
        take("extruder", "instantaneous_corner_velocity", Limit::extruder_corner_velocity, 1);
        readExtrudeOnly();
        if (const Value* advance = config_.find("extruder", "pressure_advance"))
            limits_.limits.pressure_advance =
                numberIn(advance->text, {0, gcode::kLongestAdvance}, advance->place, "pressure_advance");
        return std::move(limits_);
    }

private:
    static constexpr const char* kDefault = "Klipper's default";

    // False if the option is not there.
    bool take(const char* section, const char* option, Limit limit) {
        const Value* value = config_.find(section, option);
        if (value == nullptr) return false;
        limits_.set(limit, numberIn(value->text, gcode::boundsOf(limit), value->place, option),
                    LimitOrigin::Kind::printer, value->place);
        return true;
    }

    void take(const char* section, const char* option, Limit limit, double otherwise) {
        if (!take(section, option, limit)) limits_.set(limit, otherwise, LimitOrigin::Kind::firmware, kDefault);
    }

    void need(const char* section, const char* option, Limit limit) {
        if (!take(section, option, limit))
            throw InputError(
                fmt::format("{}: [{}] has no {}, without which Klipper doesn't start; is it in a file that is "
                            "not included?",
                            path_, section, option));
    }

    void readCruiseRatio() {
        if (take("printer", "minimum_cruise_ratio", Limit::cruise_ratio)) return;
        // Until 2025 the older option was read, where the newer one is missing.
        if (const Value* older = config_.find("printer", "max_accel_to_decel")) {
            const double acceleration =
                numberIn(older->text, gcode::boundsOf(Limit::printing), older->place, "max_accel_to_decel");
            const double ratio = 1 - std::min(1.0, acceleration / limits_.limits.printing);
            limits_.set(Limit::cruise_ratio, std::min(ratio, gcode::boundsOf(Limit::cruise_ratio).most),
                        LimitOrigin::Kind::printer, older->place);
        } else {
            limits_.set(Limit::cruise_ratio, 0.5, LimitOrigin::Kind::firmware, kDefault);
        }
    }

    void refuseAbove(const char* option, Limit limit, const char* other, Limit most) const {
        const double value = gcode::valueOf(limits_.limits, limit);
        const double bound = gcode::valueOf(limits_.limits, most);
        if (value > bound)
            throw InputError(fmt::format("{}: {} is {:g}; Klipper takes no more than {}, {:g}",
                                         limits_.origins[limit].place, option, value, other, bound));
    }

    void readExtrudeOnly() {
        const bool speed = take("extruder", "max_extrude_only_velocity", Limit::extrude_only_speed);
        const bool acceleration = take("extruder", "max_extrude_only_accel", Limit::retracting);
        if ((speed && acceleration) || !config_.has("extruder")) return;
        const double nozzle = diameter("nozzle_diameter", kNozzle);
        const double filament = diameter("filament_diameter", kFilament);
        const double ratio = 4 * nozzle * nozzle / (std::numbers::pi * filament * filament / 4);
        const auto derive = [&](Limit limit, double value) {
            limits_.set(limit, value, LimitOrigin::Kind::firmware, "Klipper's formula for nozzle and filament");
        };
        if (!speed) derive(Limit::extrude_only_speed, ratio * limits_.limits.path_speed);
        if (!acceleration) derive(Limit::retracting, ratio * limits_.limits.printing);
    }

    double diameter(const char* option, Bounds bounds) const {
        const Value* value = config_.find("extruder", option);
        if (value == nullptr)
            throw InputError(
                fmt::format("{}: [extruder] has no {}, of which Klipper makes max_extrude_only_velocity and "
                            "max_extrude_only_accel",
                            path_, option));
        return numberIn(value->text, bounds, value->place, option);
    }

    const std::string& path_;
    KlipperConfig config_;
    gcode::PrinterLimits limits_;
};

}  // namespace

gcode::PrinterLimits readKlipperLimits(const std::string& path, std::string_view text) {
    return KlipperLimits(path, text).read();
}

}  // namespace stratum::deposit
