#include "deposit/limits/limit_files.h"

#include "gcode/option_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace stratum::deposit {
namespace {

using gcode::CornerRule;
using gcode::Firmware;
using gcode::kMotionAxes;
using gcode::Limit;
using gcode::ofAxis;
using Json = nlohmann::json;

// Of x, y, z and the extruder.
constexpr std::array<std::pair<const char*, Limit>, 4> kAxisKeys{{{"speed_mm_s", Limit::speed},
                                                                  {"acceleration_mm_s2", Limit::acceleration},
                                                                  {"jerk_mm_s", Limit::jerk},
                                                                  {"steps_per_mm", Limit::steps_per_mm}}};

constexpr std::array<std::pair<const char*, Limit>, 17> kKeys{{
    {"max_velocity_mm_s", Limit::path_speed},
    {"max_accel_mm_s2", Limit::printing},  // and travel
    {"minimum_cruise_ratio", Limit::cruise_ratio},
    {"square_corner_velocity_mm_s", Limit::corner_velocity},
    {"max_z_velocity_mm_s", ofAxis(Limit::speed, 2)},
    {"max_z_accel_mm_s2", ofAxis(Limit::acceleration, 2)},
    {"max_extrude_only_velocity_mm_s", Limit::extrude_only_speed},
    {"max_extrude_only_accel_mm_s2", Limit::retracting},
    {"instantaneous_corner_velocity_mm_s", Limit::extruder_corner_velocity},
    {"arc_resolution_mm", Limit::arc_resolution},
    {"printing_mm_s2", Limit::printing},
    {"travel_mm_s2", Limit::travel},
    {"retracting_mm_s2", Limit::retracting},
    {"junction_deviation_mm", Limit::junction_deviation},
    {"least_printing_speed_mm_s", Limit::least_printing_speed},
    {"least_travel_speed_mm_s", Limit::least_travel_speed},
    {"wait_after_m400_s", Limit::wait_after_m400},
}};

class JsonLimits {
public:
    JsonLimits(JsonSection section, std::string_view bytes) : section_(std::move(section)), bytes_(bytes) {
        limits_.name = section_.file();
        limits_.limits.rule = CornerRule::automatic;
    }

    gcode::PrinterLimits read() {
        readFirmware();
        for (const auto& [key, first] : kAxisKeys) {
            const std::vector<double> numbers = section_.numbers(key, kMotionAxes);
            for (std::size_t axis = 0; axis < numbers.size(); ++axis) state(key, ofAxis(first, axis), numbers[axis]);
        }
        for (const auto& [key, limit] : kKeys) {
            const Json* number = section_.find(key);
            if (number == nullptr) continue;
            if (!number->is_number()) fail(key, limit);
            state(key, limit, number->get<double>());
            if (std::string_view(key) == "max_accel_mm_s2") state(key, Limit::travel, number->get<double>());
        }
        section_.finish();
        chooseRule();
        return limits_;
    }

private:
    void readFirmware() {
        std::string name;
        section_.read("firmware", name);
        if (name.empty()) return;
        const auto known = std::find_if(gcode::kFirmwares.begin() + 1, gcode::kFirmwares.end(),
                                        [&name](const auto& one) { return one.first == name; });
        if (known == gcode::kFirmwares.end()) section_.fail("firmware", "klipper, marlin or reprap");
        limits_.firmware = known->second;
    }

    [[noreturn]] void fail(const char* key, Limit limit) const {
        const gcode::Bounds bounds = gcode::boundsOf(limit);
        section_.fail(key, fmt::format("a number from {:g} to {:g}", bounds.least, bounds.most));
    }

    void state(const char* key, Limit limit, double value) {
        const gcode::Bounds bounds = gcode::boundsOf(limit);
        if (!(value >= bounds.least && value <= bounds.most)) fail(key, limit);
        if (isStated(limit)) section_.fail(key, "each limit once; another key says it, too");
        limits_.set(limit, value, gcode::LimitOrigin::Kind::printer,
                    fmt::format("{}:{}", section_.file(), lineOf(key)));
    }

    bool isStated(Limit limit) const { return limits_.origins[limit].kind == gcode::LimitOrigin::Kind::printer; }

    void chooseRule() {
        CornerRule& rule = limits_.limits.rule;
        if (limits_.firmware == Firmware::klipper)
            rule = CornerRule::corner_velocity;
        else if (limits_.firmware == Firmware::reprap)
            rule = CornerRule::reprap_jerk;
        else if (isStated(Limit::junction_deviation) && !isStated(Limit::jerk))
            rule = CornerRule::junction_deviation;
        else if (limits_.firmware == Firmware::marlin && isStated(Limit::jerk))
            rule = CornerRule::marlin_jerk;
        if (limits_.firmware == Firmware::klipper) limits_.limits.arcs = gcode::ArcRule::klipper;
        if (limits_.firmware == Firmware::marlin) limits_.limits.arcs = gcode::ArcRule::marlin;
        if (limits_.firmware == Firmware::reprap) limits_.limits.arcs = gcode::ArcRule::reprap;
    }

    std::size_t lineOf(const char* key) const {
        const std::size_t limits = std::min(bytes_.find("\"limits\""), bytes_.size());
        const std::size_t place = std::min(bytes_.find(fmt::format("\"{}\"", key), limits), bytes_.size());
        return 1 +
               static_cast<std::size_t>(std::count(bytes_.begin(), bytes_.begin() + static_cast<long>(place), '\n'));
    }

    JsonSection section_;
    std::string_view bytes_;
    gcode::PrinterLimits limits_;
};

}  // namespace

gcode::PrinterLimits readJsonLimits(JsonSection section, std::string_view bytes) {
    return JsonLimits(std::move(section), bytes).read();
}

}  // namespace stratum::deposit
