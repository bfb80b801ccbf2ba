#include "deposit/printer.h"

#include "base/error.h"
#include "base/json_section.h"
#include "base/mapped_file.h"
#include "base/nearest_name.h"
#include "gcode/machine/machine_limits.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace stratum::deposit {
namespace {

using gcode::DepositModel;
using Json = nlohmann::json;

constexpr std::array<std::string_view, 2> kPresets{"ideal", "typical"};

// docs/deposit.md, "Printers", says where each number is from.
DepositModel typicalPrinter() {
    DepositModel deposit;
    deposit.beads = DepositModel::Beads::settled;
    deposit.flow_lag = 0.015;
    deposit.pressure_advance = 0;
    deposit.sag = 0.02;
    return deposit;
}

// A number within bounds, if the key is there.
bool readNumber(JsonSection& section, const char* key, double least, double most, double& value) {
    const Json* j = section.find(key);
    if (j == nullptr) return false;
    if (!j->is_number() || !(j->get<double>() >= least && j->get<double>() <= most))
        section.fail(key, fmt::format("a number from {:g} to {:g}", least, most));
    value = j->get<double>();
    return true;
}

void readAxes(JsonSection& section, const char* key, double least, double most,
              std::array<double, gcode::kMotionAxes>& values) {
    const std::vector<double> numbers = section.numbers(key, gcode::kMotionAxes);
    for (std::size_t axis = 0; axis < numbers.size(); ++axis) {
        if (!(numbers[axis] >= least && numbers[axis] <= most))
            section.fail(key, fmt::format("numbers from {:g} to {:g}, for x, y, z and the extruder", least, most));
        values[axis] = numbers[axis];
    }
}

gcode::MachineLimits readLimits(JsonSection section) {
    using namespace gcode;
    MachineLimits limits;
    readAxes(section, "speed_mm_s", 1e-3, kFastestAxis, limits.speed);
    readAxes(section, "acceleration_mm_s2", kWeakestAxis, kStrongestAxis, limits.acceleration);
    readAxes(section, "jerk_mm_s", 0, kFastestAxis, limits.jerk);
    readNumber(section, "printing_mm_s2", kWeakestAxis, kStrongestAxis, limits.printing);
    readNumber(section, "travel_mm_s2", kWeakestAxis, kStrongestAxis, limits.travel);
    readNumber(section, "retracting_mm_s2", kWeakestAxis, kStrongestAxis, limits.retracting);
    readNumber(section, "junction_deviation_mm", 1e-6, kLongestDeviation, limits.junction_deviation);
    readNumber(section, "corner_velocity_mm_s", 0, kFastestAxis, limits.corner_velocity);
    section.finish();
    return limits;
}

void readPrinter(const std::string& path, gcode::ReadOptions& options) {
    const MappedFile file(path);
    constexpr std::size_t kLargestFile = 1 << 20;
    if (file.bytes().size() > kLargestFile)
        throw InputError(
            fmt::format("{}: {} bytes are too many for a printer; is it the right file?", path, file.bytes().size()));
    Json json;
    try {
        json = Json::parse(file.bytes());
    } catch (const Json::exception& error) {
        throw InputError(
            fmt::format("{}: no JSON: {}; docs/deposit.md has an example of a printer", path, error.what()));
    }
    JsonSection section(json, "", path);
    DepositModel deposit;
    std::string beads;
    section.read("beads", beads);
    if (!beads.empty() && beads != "capsule" && beads != "settled") section.fail("beads", "capsule or settled");
    if (beads == "settled") deposit.beads = DepositModel::Beads::settled;
    if (const Json* corner = section.find("section")) {
        if (!corner->is_string()) section.fail("section", "a text as --section has it, e.g. \"50%\"");
        try {
            parseSection(corner->get<std::string>(), deposit);
        } catch (const UsageError&) {
            section.fail("section", "\"stadium\", a corner radius in mm (\"0.05\"), or \"50%\" of half the height");
        }
    }
    double lag = 0;
    double advance = 0;
    if (readNumber(section, "flow_lag_s", 0, kLongestLag, lag)) deposit.flow_lag = lag;
    if (readNumber(section, "pressure_advance_s", 0, gcode::kLongestAdvance, advance))
        deposit.pressure_advance = advance;
    readNumber(section, "nozzle_diameter_mm", 0.05, 10, deposit.nozzle_diameter);
    readNumber(section, "sag", 0, kMostSag, deposit.sag);
    if (auto limits = section.section("limits")) options.limits = readLimits(std::move(*limits));
    section.finish();
    options.deposit = deposit;
}

}  // namespace

void usePrinter(const std::string& preset, gcode::ReadOptions& options) {
    if (preset == "ideal") {
        options.deposit = {};
    } else if (preset == "typical") {
        options.deposit = typicalPrinter();
    } else if (std::filesystem::exists(preset)) {
        readPrinter(preset, options);
    } else {
        throw UsageError(fmt::format("--printer {}: expected ideal, typical, or a JSON file of a printer{}", preset,
                                     didYouMean(preset, kPresets)));
    }
}

void parseSection(const std::string& text, DepositModel& deposit) {
    deposit.corner_mm.reset();
    deposit.corner_fraction = 1;
    if (text == "stadium") return;
    const bool percent = text.ends_with('%');
    const char* const last = text.data() + text.size() - (percent ? 1 : 0);
    double value = 0;
    const auto [end, error] = fast_float::from_chars(text.data(), last, value);
    constexpr double kLargest = 100;  // mm, or per cent
    if (error != std::errc() || end != last || !(value >= 0 && value <= kLargest))
        throw UsageError(fmt::format(
            "--section {}: expected stadium, a corner radius in mm (0.05), or a percentage of half the height (50%)",
            text));
    if (percent)
        deposit.corner_fraction = value / 100;
    else
        deposit.corner_mm = value;
}

}  // namespace stratum::deposit
