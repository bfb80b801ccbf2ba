#include "gcode/slicer/cura_machines.h"

#include "base/text.h"
#include "gcode/machine/machine_limits.h"
#include "gcode/text/setting_text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace stratum::gcode {
namespace {

constexpr double kNone = 500;  // mm/s; Cura's own "no limit" is the speed of light

// Machines whose letters and digits, in lower case, begin with `name`. The first that fits counts.
struct Machines {
    std::string_view name;
    std::array<double, kMotionAxes> speed;                                                // mm/s
    double x_acceleration, y_acceleration, z_acceleration, e_acceleration, acceleration;  // mm/s^2
    double xy_jerk, z_jerk, e_jerk;                                                       // mm/s
};

// clang-format off
constexpr std::array kMachines{
    Machines{"k1",                     {800, 800, kNone, kNone}, 20000, 20000, 500, 5000, 20000, 20, .4, 5},
    Machines{"crealitycrx",            {kNone, kNone, kNone, kNone}, 500, 500, 100, 5000, 4000, 5, .4, 5},
    Machines{"creality",               {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"creawsome",              {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"anet",                   {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"artillery",              {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"blvmgncube",             {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"goofoo",                 {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"longer",                 {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"mingda",                 {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"renkforce",              {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"weedo",                  {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"sv01",                   {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"sv03",                   {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"sv02",                   {500, 500, 10, 50}, 500, 500, 100, 500, 500, 5, .4, 5},
    Machines{"biqu",                   {500, 500, 10, 75}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"anycubicmegazero",       {500, 500, 5, 30}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"anycubici3megas",        {kNone, kNone, kNone, kNone}, 3000, 3000, 3000, 3000, 3000, 10, .4, 5},
    Machines{"anycubic4max",           {300, 300, 10, kNone}, 1500, 1500, 100, 10000, 1500, 11, .4, 11},
    Machines{"elegoo",                 {kNone, kNone, kNone, kNone}, 1000, 1000, 100, 5000, 1000, 8, .4, 5},
    Machines{"koonovo",                {200, 200, 50, 100}, 500, 500, 50, 2000, 500, 20, .4, 5},
    Machines{"flyingbearghost4",       {200, 200, 20, 70}, 1000, 1000, 100, 1000, 1000, 20, .4, 5},
    Machines{"flyingbearghost",        {300, 300, 20, 70}, 1000, 1000, 200, 80000, 1000, 20, .4, 5},
    Machines{"kingroonkp3s",           {200, 200, 4, 100}, 1000, 1000, 100, 1000, 1000, 15, .4, 5},
    Machines{"kingroonkp3",            {100, 100, 10, 100}, 500, 500, 50, 500, 500, 10, .3, 5},
    Machines{"alfawiseu30",            {200, 200, 5, 100}, 500, 500, 10, 3000, 300, 20, .4, 5},
    Machines{"tevotarantulapro",       {200, 200, 9, kNone}, 2000, 2000, 100, 10000, 2000, 15, .4, 5},
    Machines{"tevotarantula",          {255, 225, 3, kNone}, 2650, 2650, 100, 10000, 2650, 15, .4, 5},
    Machines{"tevotornado",            {kNone, kNone, kNone, kNone}, 9000, 9000, 100, 10000, 1500, 6, .4, 5},
    Machines{"tronxyx5sa",             {100, 100, 20, 120}, 120, 120, 120, 120, 100, 20, .4, 5},
    Machines{"tronxyxy2pro",           {100, 100, 20, 120}, 120, 120, 120, 120, 150, 20, .4, 5},
    Machines{"tronxyxy",               {100, 100, 20, 120}, 150, 150, 150, 150, 80, 20, .4, 5},
    Machines{"geeetecha30",            {300, 300, 7, 50}, 2000, 2000, 100, 10000, 2000, 10, 1, 5},
    Machines{"geeetecha",              {kNone, kNone, 12, 120}, 9000, 9000, 500, 10000, 1000, 10, .2, 2.5},
    Machines{"prusai3mk",              {kNone, kNone, 12, 120}, 9000, 9000, 500, 10000, 1000, 10, .2, 2.5},
    Machines{"snapmaker",              {kNone, kNone, kNone, kNone}, 1000, 1000, 1000, 1000, 1000, 20, .4, 5},
    Machines{"monopriceselectmini",    {150, 150, 1.5, 100}, 800, 800, 20, 10000, 4000, 20, .4, 5},
    Machines{"malyanm200",             {150, 150, 1.5, 100}, 800, 800, 20, 10000, 4000, 20, .4, 5},
    Machines{"monopriceultimate",      {kNone, kNone, kNone, kNone}, 3000, 3000, 100, 500, 800, 10, .4, 1},
    Machines{"printrbotplay",          {125, 125, 5, kNone}, 2000, 2000, 30, 10000, 4000, 20, .4, 5},
    Machines{"dagomadisco",            {500, 500, 4, 170}, 3000, 1000, 20, 10000, 3000, 20, .4, 5},
    Machines{"xyzprinting",            {500, 500, 10, 50}, 1500, 1500, 500, 5000, 500, 10, .4, 5},
    Machines{"flashforgedreamer",      {500, 500, 10, 50}, 1500, 1500, 500, 5000, 500, 10, .4, 5},
    Machines{"dreamernx",              {500, 500, 10, 50}, 1500, 1500, 500, 5000, 500, 10, .4, 5},
    Machines{"lulzbotmini2",           {800, 800, 8, 40}, 9000, 9000, 100, 1000, 1000, 20, .4, 5},
    Machines{"lulzbottazpro",          {800, 800, 3, 40}, 9000, 9000, 100, 1000, 500, 20, .4, 5},
    Machines{"leapfrogboltpro",        {kNone, kNone, 16.7, 50}, 9000, 9000, 100, 10000, 400, 20, .4, 5},
    Machines{"ultimakeroriginal",      {kNone, kNone, kNone, 45}, 9000, 9000, 100, 10000, 4000, 20, .4, 5},
    Machines{"ultimaker2",             {300, 300, 40, 45}, 9000, 9000, 100, 10000, 3000, 20, .4, 5},
    Machines{"ultimaker3",             {300, 300, 40, 45}, 9000, 9000, 100, 10000, 3000, 20, .4, 5},
    Machines{"ultimakers",             {300, 300, 40, 45}, 9000, 9000, 100, 10000, 3000, 20, .4, 5},
};
constexpr Machines kAnyMachine{"",     {kNone, kNone, kNone, kNone}, 9000, 9000, 100, 10000, 4000, 20, .4, 5};
// clang-format on

const Machines* machinesNamed(std::string_view machine) {
    std::string plain;
    for (const char c : machine)
        if (isLetter(c) || (c >= '0' && c <= '9')) plain += lowerCase(c);
    const auto* found = std::find_if(kMachines.begin(), kMachines.end(), [&](const Machines& one) {
        return std::string_view(plain).starts_with(one.name);
    });
    return found == kMachines.end() ? nullptr : found;
}

void setAll(MachineLimits& limits, double acceleration) {
    limits.printing = limits.retracting = limits.travel = acceleration;
}

}  // namespace

bool isCuraMachine(std::string_view machine) { return machinesNamed(machine) != nullptr; }

MachineLimits curaLimits(std::string_view machine) {
    const Machines* const known = machinesNamed(machine);
    const Machines& m = known != nullptr ? *known : kAnyMachine;
    MachineLimits limits;
    limits.speed = m.speed;
    limits.acceleration = {m.x_acceleration, m.y_acceleration, m.z_acceleration, m.e_acceleration};
    limits.jerk = {m.xy_jerk, m.xy_jerk, m.z_jerk, m.e_jerk};
    setAll(limits, m.acceleration);
    limits.rule = CornerRule::plan_jerk;
    return limits;
}

bool setCuraLimit(std::string_view key, std::string_view value, MachineLimits& limits) {
    constexpr std::string_view kAxes = "xyze";
    const auto taken = [&value](Limit limit) {
        const std::vector<double> numbers = numbersOf(value, boundsOf(limit).least, boundsOf(limit).most);
        return numbers.size() == 1 ? std::optional(numbers.front()) : std::nullopt;
    };
    const auto axis = kAxes.find(key.empty() ? ' ' : key.back());
    if (key == "machine_acceleration") {
        if (const auto most = taken(Limit::acceleration)) return setAll(limits, *most), true;
    } else if (key == "machine_max_jerk_xy") {
        if (const auto jerk = taken(Limit::jerk)) return limits.jerk[0] = limits.jerk[1] = *jerk, true;
    } else if (axis == std::string_view::npos) {
        return false;
    } else if (key.starts_with("machine_max_acceleration_")) {
        if (const auto most = taken(Limit::acceleration)) return limits.acceleration[axis] = *most, true;
    } else if (key.starts_with("machine_max_feedrate_")) {
        if (const auto speed = taken(Limit::speed)) return limits.speed[axis] = *speed, true;
    } else if (key.starts_with("machine_max_jerk_")) {
        if (const auto jerk = taken(Limit::jerk)) return limits.jerk[axis] = *jerk, true;
    }
    return false;
}

}  // namespace stratum::gcode
