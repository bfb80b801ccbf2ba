#include "gcode/slicer/cura.h"

#include "base/base64.h"
#include "base/text.h"
#include "gcode/container/gzip.h"
#include "gcode/printer/machine_limits.h"
#include "gcode/text/setting_text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMostProfile = std::size_t{1} << 20;  // bytes of an unpacked profile; real ones have 10 kB
constexpr std::size_t kMostExtruders = 32;

// What zlib data unpacks to; empty if it is damaged.
std::string inflated(std::string& bytes) {
    Inflater inflater(15);
    z_stream& stream = inflater.stream;
    std::string text(std::min(kMostProfile, bytes.size() * std::size_t{kDeflateMostRatio}), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    if (inflate(&stream, Z_FINISH) != Z_STREAM_END) return {};
    text.resize(stream.total_out);
    return text;
}

// Adds the settings of a profile: one a part, key and value separated by '='.
void addAll(std::string_view profile, char separator, std::optional<std::size_t> extruder,
            std::vector<CuraSetting>& settings) {
    while (!profile.empty()) {
        const std::string_view one = takePiece(profile, separator);
        const auto equals = one.find('=');
        if (equals == std::string_view::npos) continue;
        const std::string_view key = trim(one.substr(0, equals));
        if (key == "position" && extruder) {
            // An extruder's profile names its number, which its place in the list need not be.
            const std::string_view value = trim(one.substr(equals + 1));
            if (value.size() == 1 && value[0] >= '0' && value[0] <= '9')
                extruder = static_cast<std::size_t>(value[0] - '0');
        }
        settings.push_back({extruder, std::string(key), std::string(trim(one.substr(equals + 1)))});
    }
}

// The JSON string whose opening quote is at the start of `text`, which it removes. Profiles are escaped once or twice.
std::string takeString(std::string_view& text) {
    std::string plain;
    std::size_t at = 1;
    for (; at < text.size() && text[at] != '"'; ++at) {
        if (text[at] != '\\') {
            plain += text[at];
            continue;
        }
        while (at + 1 < text.size() && text[at + 1] == '\\') ++at;
        if (at + 1 < text.size()) plain += text[++at] == 'n' ? '\n' : text[at];
    }
    text.remove_prefix(std::min(at + 1, text.size()));
    return plain;
}

}  // namespace

bool CuraProfile::comment(std::string_view comment) {
    constexpr std::string_view kJson = "SETTING_3 ";
    constexpr std::string_view kProfile = "CURA_PROFILE_STRING:";
    if (comment.starts_with(kJson)) {
        json_ += comment.substr(kJson.size());
        return true;
    }
    if (!comment.starts_with(kProfile)) return false;
    readProfileString(comment.substr(kProfile.size()));
    return true;
}

void CuraProfile::readProfileString(std::string_view base64) {
    cura_15_ = true;
    std::string bytes = bytesOfBase64(base64.substr(0, kMostProfile));
    const std::string profile = bytes.empty() ? std::string() : inflated(bytes);
    damaged_ = damaged_ || profile.empty();
    addAll(std::string_view(profile).substr(0, profile.find('\f')), '\b', std::nullopt, settings_);
}

std::vector<CuraSetting> CuraProfile::settings() {
    // {"global_quality": "...", "extruder_quality": ["...", "..."]}: other keys than these hold no settings.
    std::string_view text = json_;
    bool of_extruders = false;
    std::size_t extruder = 0;
    while (true) {
        text.remove_prefix(std::min(text.find('"'), text.size()));
        if (text.empty()) break;
        const std::string part = takeString(text);
        if (part == "extruder_quality")
            of_extruders = true;
        else if (part == "global_quality")
            of_extruders = false;  // the keys come in either order
        else if (part.find('=') != std::string::npos && extruder < kMostExtruders)
            addAll(part, '\n', of_extruders ? std::optional(extruder++) : std::nullopt, settings_);
    }
    return std::move(settings_);
}

namespace {

constexpr double kNone = 500;  // mm/s; Cura's own "no limit" is the speed of light

// Machines whose letters and digits, in lower case, begin with one of `names`. The first that fits counts.
struct Machines {
    std::string_view names;                                                               // between bars
    std::array<double, kMotionAxes> speed;                                                // mm/s
    double x_acceleration, y_acceleration, z_acceleration, e_acceleration, acceleration;  // mm/s^2
    double xy_jerk, z_jerk, e_jerk;                                                       // mm/s
};

// clang-format off
constexpr std::array kMachines{
    Machines{"k1",                     {800, 800, kNone, kNone}, 20000, 20000, 500, 5000, 20000, 20, .4, 5},
    Machines{"crealitycrx",            {kNone, kNone, kNone, kNone}, 500, 500, 100, 5000, 4000, 5, .4, 5},
    Machines{"creality|creawsome|anet|artillery|blvmgncube|goofoo|longer|mingda|renkforce|weedo|sv01|sv03",
                                       {500, 500, 10, 50}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"sv02",                   {500, 500, 10, 50}, 500, 500, 100, 500, 500, 5, .4, 5},
    Machines{"biqu",                   {500, 500, 10, 75}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"anycubicmegazero",       {500, 500, 5, 30}, 500, 500, 100, 5000, 500, 10, .4, 5},
    Machines{"anycubici3megas",        {kNone, kNone, kNone, kNone}, 3000, 3000, 3000, 3000, 3000, 10, .4, 5},
    Machines{"anycubic4max",           {300, 300, 10, kNone}, 1500, 1500, 100, 10000, 1500, 11, .4, 11},
    Machines{"elegooneptune4",         {kNone, kNone, kNone, kNone}, 5000, 5000, 100, 5000, 3000, 8, .4, 5},
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
    Machines{"geeetecha|prusai3mk", {kNone, kNone, 12, 120}, 9000, 9000, 500, 10000, 1000, 10, .2, 2.5},
    Machines{"snapmaker",              {kNone, kNone, kNone, kNone}, 1000, 1000, 1000, 1000, 1000, 20, .4, 5},
    Machines{"monopriceselectmini|malyanm200", {150, 150, 1.5, 100}, 800, 800, 20, 10000, 4000, 20, .4, 5},
    Machines{"monopriceultimate",      {kNone, kNone, kNone, kNone}, 3000, 3000, 100, 500, 800, 10, .4, 1},
    Machines{"printrbotplay",          {125, 125, 5, kNone}, 2000, 2000, 30, 10000, 4000, 20, .4, 5},
    Machines{"dagomadisco",            {500, 500, 4, 170}, 3000, 1000, 20, 10000, 3000, 20, .4, 5},
    Machines{"xyzprinting|flashforgedreamer|dreamernx", {500, 500, 10, 50}, 1500, 1500, 500, 5000, 500, 10, .4, 5},
    Machines{"lulzbotmini2",           {800, 800, 8, 40}, 9000, 9000, 100, 1000, 1000, 20, .4, 5},
    Machines{"lulzbottazpro",          {800, 800, 3, 40}, 9000, 9000, 100, 1000, 500, 20, .4, 5},
    Machines{"leapfrogboltpro",        {kNone, kNone, 16.7, 50}, 9000, 9000, 100, 10000, 400, 20, .4, 5},
    Machines{"ultimakeroriginal",      {kNone, kNone, kNone, 45}, 9000, 9000, 100, 10000, 4000, 20, .4, 5},
    Machines{"ultimaker2|ultimaker3|ultimakers", {300, 300, 40, 45}, 9000, 9000, 100, 10000, 3000, 20, .4, 5},
};
constexpr Machines kAnyMachine{"",     {kNone, kNone, kNone, kNone}, 9000, 9000, 100, 10000, 4000, 20, .4, 5};
// clang-format on

const Machines* machinesNamed(std::string_view machine) {
    std::string plain;
    for (const char c : machine)
        if (isLetter(c) || (c >= '0' && c <= '9')) plain += lowerCase(c);
    const auto* found = std::find_if(kMachines.begin(), kMachines.end(), [&](const Machines& one) {
        const auto names = split(one.names, '|');
        return std::any_of(names.begin(), names.end(), [&](std::string_view name) { return plain.starts_with(name); });
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
