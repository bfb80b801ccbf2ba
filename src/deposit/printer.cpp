#include "deposit/printer.h"

#include "base/error.h"
#include "base/names.h"
#include "base/options/json_section.h"
#include "base/text.h"
#include "deposit/limits/limit_files.h"
#include "deposit/limits/printer_text.h"
#include "gcode/printer/machine_limits.h"

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
constexpr std::string_view kKinds =
    "Klipper's printer.cfg, RepRapFirmware's config.g, a report of Marlin's M503, or JSON";

// docs/deposit.md, "Printers", says where each number is from.
DepositModel typicalPrinter() {
    DepositModel deposit;
    deposit.beads = DepositModel::Beads::settled;
    deposit.flow_lag = 0.003;
    deposit.pressure_advance = 0;
    deposit.sag = 0.02;
    deposit.crown = 0.2;
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

bool isJson(std::string_view text) {
    text = trim(text, " \t\r\n");
    return text.starts_with('{') || (text.starts_with('[') && !looksLikeKlipperConfig(text));
}

// A file of a firmware, told by its content.
gcode::PrinterLimits readFirmwareLimits(const std::string& path, std::string_view text) {
    if (trim(text, " \t\r\n").empty()) throw InputError(fmt::format("{}: is empty; expected {}", path, kKinds));
    if (looksLikeKlipperConfig(text)) return readKlipperLimits(path, text);
    const auto firmware = firmwareOfCommands(path, text);
    if (!firmware) throw InputError(fmt::format("{}: no limit of a printer in it; expected {}", path, kKinds));
    return readCommandLimits(path, text, *firmware);
}

// Of the project's own JSON.
void readJson(const std::string& path, const std::string& text, gcode::ReadOptions& options) {
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::exception& error) {
        throw InputError(
            fmt::format("{}: no JSON: {}; docs/printers.md has an example of a printer", path, error.what()));
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
    section.read("strings", deposit.strings);
    readNumber(section, "sag", 0, kMostSag, deposit.sag);
    readNumber(section, "crown", 0, gcode::kMostCrown, deposit.crown);
    if (const Json* limits = section.find("limits"); limits != nullptr && limits->is_string()) {
        const auto other = std::filesystem::path(path).parent_path() / limits->get<std::string>();
        options.printer =
            readFirmwareLimits(other.string(), readIncludedText(other.string(), section.file() + ": limits"));
    } else if (auto keys = section.section("limits")) {
        options.printer = readJsonLimits(std::move(*keys), text);
    }
    section.finish();
    options.deposit = deposit;
}

void readPrinter(const std::string& path, gcode::ReadOptions& options) {
    const std::string text = readPrinterText(path, path);
    if (isJson(text)) return readJson(path, text, options);
    options.printer = readFirmwareLimits(path, text);
}

}  // namespace

void usePrinter(const std::string& preset, gcode::ReadOptions& options) {
    if (preset == "ideal") {
        options.deposit = {};
    } else if (preset == "typical") {
        options.deposit = typicalPrinter();
    } else if (std::error_code failed; std::filesystem::exists(preset, failed)) {
        readPrinter(preset, options);
    } else {
        throw UsageError(fmt::format("--printer {}: expected ideal, typical, or a file that is there: {}{}", preset,
                                     kKinds, didYouMean(preset, kPresets)));
    }
}

void parseSection(const std::string& text, DepositModel& deposit) {
    deposit.corner_mm.reset();
    deposit.corner_fraction = 1;
    if (text == "stadium") return;
    const bool percent = text.ends_with('%');
    const auto value = parsed<double>(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
    constexpr double kLargest = 100;  // mm, or per cent
    if (!value || !(*value >= 0 && *value <= kLargest))
        throw UsageError(fmt::format(
            "--section {}: expected stadium, a corner radius in mm (0.05), or a percentage of half the height (50%)",
            text));
    if (percent)
        deposit.corner_fraction = *value / 100;
    else
        deposit.corner_mm = *value;
}

}  // namespace stratum::deposit
