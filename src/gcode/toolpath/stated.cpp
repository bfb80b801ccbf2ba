#include "gcode/toolpath/stated.h"

#include "base/text.h"
#include "gcode/text/number.h"
#include "gcode/text/setting_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace stratum::gcode {
namespace {

constexpr double kLongest = 1e9;  // s, thirty years
constexpr double kDensest = 25;   // g/cm^3
constexpr double kDearest = 1e9;  // a kg
constexpr double kWidest = 1e5;   // mm, of a bed

// Each part of a list, with its number.
template <typename Take>
void split(std::string_view text, std::string_view separators, const Take& part) {
    std::size_t tool = 0;
    for (const std::string_view one : partsOf(text, separators)) part(tool++, one);
}

// The sum of grams by tool; absent if one is no number, or all are 0, which slicers write if the density is unknown.
std::optional<double> sum(std::string_view text) {
    double total = 0;
    bool good = true;
    for (const std::string_view part : partsOf(text, ",;")) {
        const char* p = part.data();
        double value = 0;
        good = good && parseNumber(p, p + part.size(), value) && value >= 0 && value < 1e9;
        total += value;
    }
    return good && total > 0 ? std::optional(total) : std::nullopt;
}

// "0x0,250x0,250x210,0x210"; OrcaSlicer states both forms, PrusaSlicer's without corners that are cut off. Empty if one
// is none.
std::vector<std::array<double, 2>> cornersOf(std::string_view outline) {
    std::vector<std::array<double, 2>> corners;
    for (const std::string_view part : partsOf(outline, ",")) {
        const char* p = part.data();
        const char* const end = p + part.size();
        std::array<double, 2> corner{};
        if (!parseNumber(p, end, corner[0]) || p == end || *p != 'x' || !parseNumber(++p, end, corner[1])) return {};
        if (!(std::max(std::abs(corner[0]), std::abs(corner[1])) <= kWidest)) return {};
        corners.push_back(corner);
    }
    return corners;
}

// The tool of "Extruder 1 Material", which it removes from the text up to what follows the number.
std::optional<std::size_t> takeTool(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix) || text.size() == prefix.size()) return std::nullopt;
    const char digit = text[prefix.size()];
    if (digit < '0' || digit > '9') return std::nullopt;
    text.remove_prefix(prefix.size() + 1);
    return static_cast<std::size_t>(digit - '0');
}

}  // namespace

namespace {

// "1:56:46": hours, minutes, seconds.
std::optional<double> clockTime(std::string_view text) {
    double total = 0;
    std::size_t parts = 0;
    for (const std::string_view part : partsOf(text, ":")) {
        if (part.empty() || part.size() > 5 || part.find_first_not_of("0123456789") != std::string_view::npos ||
            ++parts > 3)
            return std::nullopt;
        double value = 0;
        for (const char digit : part) value = 10 * value + (digit - '0');
        if (parts > 1 && value >= 60) return std::nullopt;
        total = 60 * total + value;
    }
    return parts == 3 ? std::optional(total) : std::nullopt;
}

}  // namespace

std::optional<double> parseDuration(std::string_view text) {
    constexpr std::array kUnits{std::pair{'d', 86400.0}, std::pair{'h', 3600.0}, std::pair{'m', 60.0},
                                std::pair{'s', 1.0}};
    text = trimQuoted(text);
    if (const auto clock = clockTime(text)) return clock;
    double total = 0;
    bool any = false;
    bool units = false;  // so that what follows may be prose; a date begins with a number too
    const auto bounded = [&total](bool known) {
        return known && total <= kLongest ? std::optional(total) : std::nullopt;
    };
    while (!text.empty()) {
        const char* p = text.data();
        const char* const end = p + text.size();
        double value = 0;
        if (!parseNumber(p, end, value) || value < 0) return bounded(units);
        text.remove_prefix(static_cast<std::size_t>(p - text.data()));
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        const auto word = static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), isLetter) - text.begin());
        const auto* unit = std::find_if(kUnits.begin(), kUnits.end(),
                                        [&](const auto& one) { return word > 0 && (text[0] | 0x20) == one.first; });
        if (unit == kUnits.end() && (any || word > 0)) return bounded(units);
        total += value * (unit == kUnits.end() ? 1 : unit->second);
        any = true;
        units = units || word > 0;
        text.remove_prefix(word);
        text.remove_prefix(std::min(text.find_first_not_of(" :,"), text.size()));
    }
    return bounded(any);
}

std::string describeDuration(double seconds) {
    const auto whole = std::llround(seconds);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min {} s", whole / 3600, whole / 60 % 60, whole % 60);
}

bool StatedFacts::empty() const {
    return !seconds && !model_seconds && !grams && materials.empty() && nozzle_diameters.empty() && printer.empty() &&
           !layer_height && !first_layer_height;
}

void StatedReader::comment(std::string_view text) {
    if (const auto setting = keyAndValue(text)) return pair(setting->first, setting->second);
    // BambuStudio states two times in one comment.
    if (text.starts_with("model printing time:"))
        if (const auto cut = text.find(';'); cut != std::string_view::npos) {
            comment(trimQuoted(text.substr(cut + 1)));
            text = text.substr(0, cut);
        }
    if (text.starts_with("--- ") && text.ends_with(" ---"))
        text = trimQuoted(text.substr(4, text.size() - 8));  // Kiri:Moto
    if (const auto colon = text.find(':'); colon != std::string_view::npos)
        return sentence(trimQuoted(text.substr(0, colon)), trimQuoted(text.substr(colon + 1)));
    if (const auto comma = text.find(','); comma != std::string_view::npos)
        setting(text.substr(0, comma), trimQuoted(text.substr(comma + 1)));
}

void StatedReader::pair(std::string_view key, std::string_view value) {
    if (key == "estimated printing time (normal mode)" || key == "estimated printing time" ||
        key == "total print time (s)") {  // the last is MatterSlice's
        if (const auto time = parseDuration(value)) facts_.seconds = time;
    } else if (key == "total filament used [g]") {
        if (const auto grams = sum(value)) {
            facts_.grams = grams;
            total_grams_ = true;
        }
    } else if (key == "filament used [g]") {
        if (const auto grams = sum(value); grams && !total_grams_) facts_.grams = grams;
    } else if (key == "total filament cost" || key == "filament cost") {
        // 0: nobody has given a price.
        const bool total = key.starts_with("total");
        if (const auto cost = sum(value); cost && *cost > 0 && (total || !total_cost_)) facts_.cost = cost;
        total_cost_ = total_cost_ || total;
    } else if (key == "filament_type") {
        split(value, ";,", [this](std::size_t tool, std::string_view name) { setMaterial(tool, name); });
    } else if (key == "filament_settings_id") {
        facts_.profiles.clear();
        split(value, ";",
              [this](std::size_t, std::string_view name) { facts_.profiles.emplace_back(trimQuoted(name)); });
    } else if (key == "nozzle_diameter") {
        split(value, ",;", [this](std::size_t tool, std::string_view size) { setNozzle(tool, size); });
    } else if (key == "filament_density") {
        setNumbers(value, kDensest, facts_.densities);
    } else if (key == "filament_cost") {
        setNumbers(value, kDearest, facts_.prices);
    } else if (key == "bed_shape" || key == "printable_area") {  // PrusaSlicer's, OrcaSlicer's
        if (auto corners = cornersOf(value); corners.size() >= 3) facts_.bed = std::move(corners);
    } else if (key == "bed_exclude_area") {  // BambuStudio's, OrcaSlicer's
        setExcluded(value);
    } else if (key == "bed_size_x_mm" || key == "bed_size_y_mm") {  // KISSlicer's
        setBedSide(key[9] == 'x' ? 0 : 1, value);
    } else if (key == "printer_model" || key == "printer_name") {
        if (!value.empty()) facts_.printer = value;
    } else if (key == "printer_settings_id") {
        if (!value.ends_with(".3mf")) profile_ = value;  // of a project, as Canvas has it
    } else if (key == "layer_height" || key == "sliceHeight" || key == "layer_thickness_mm" ||
               key == "layerThickness") {
        if (const auto height = positiveNumber(value, 100)) facts_.layer_height = height;
    } else if (key == "first_layer_height" || key == "initial_layer_print_height" || key == "firstSliceHeight" ||
               key == "first_layer_thickness_mm" || key == "firstLayerThickness") {
        const bool share = value.ends_with('%');
        const auto height = positiveNumber(value, share ? 1000 : 100);
        if (share && height) first_share_ = *height / 100;
        if (!share && height) facts_.first_layer_height = height;
    }
}

void StatedReader::sentence(std::string_view key, std::string_view value) {
    if (key == "TIME" || key == "PRINT.TIME" || key == "Print Time" || key == "Print time" || key == "print time" ||
        key == "Build time" || key == "Estimated Build Time" || key == "total estimated time" ||
        key == "estimated_time(s)" || key == "Estimated Print Time" || key == "est. Print time" ||
        key == "Duration") {  // the last two: FABtotum's Cura 15, Miracle-Grue
        if (const auto time = parseDuration(value)) facts_.seconds = time;
    } else if (key == "TIME_ELAPSED") {
        elapsed_ = parseDuration(value);
    } else if (key == "model printing time") {
        facts_.model_seconds = parseDuration(value);
    } else if (key == "total filament weight [g]" || key == "Plastic weight") {
        if (const auto grams = sum(value)) facts_.grams = grams;
    } else if (key == "Material cost") {  // Simplify3D's
        if (const auto cost = sum(value); cost && *cost > 0) facts_.cost = cost;
    } else if (key == "machine_type" || key == "TARGET_MACHINE.NAME" || key == "Target" || key == "Printer" ||
               key == "Machine Name" || key == "MachineType") {  // the last: WEEDO
        if (!value.empty()) facts_.printer = value;
    } else if (key == "Belt Printer" || key == "Bed type") {
        facts_.belt = facts_.belt || value == "1" || value == "belt";
    } else if (key == "Belt Gantry Angle") {
        facts_.belt_angle = positiveNumber(value, 90);
    } else if (key == "Material Type" || key == "FilamentType") {
        setMaterial(0, value);
    } else if (key == "ExtruderParams[0] Nozzle Diameter" || key == "Nozzle Size") {
        setNozzle(0, value);
    } else if (key == "right_extruder_material" || key == "left_extruder_material") {
        setMaterial(key.starts_with("left") ? 1 : 0, value);
    } else if (key == "layer_height" || key == "Layer height" || key == "Layer Height") {
        if (const auto height = positiveNumber(value, 100)) facts_.layer_height = height;
    } else if (const auto train = takeTool(key, "EXTRUDER_TRAIN.")) {
        if (key == ".NOZZLE.DIAMETER") setNozzle(*train, value);
    } else if (const auto extruder = takeTool(key, "Extruder ")) {
        if (key == " Nozzle Size") setNozzle(*extruder, value);
        if (key == " Material") setMaterial(*extruder, value);
    }
}

void StatedReader::setting(std::string_view key, std::string_view value) {
    if (key == "printMaterial") {
        setMaterial(0, value);
    } else if (key == "extruderDiameter") {
        split(value, ",|", [this](std::size_t tool, std::string_view size) { setNozzle(tool, size); });
    } else if (key == "filamentDensities") {
        setNumbers(value, kDensest, facts_.densities);
    } else if (key == "filamentPricesPerKg") {
        setNumbers(value, kDearest, facts_.prices);
    } else if (key == "strokeXoverride" || key == "strokeYoverride") {
        setBedSide(key[6] == 'X' ? 0 : 1, value);
    } else if (key == "profileName") {
        profile_ = value;
    } else if (key == "layerHeight") {
        facts_.layer_height = positiveNumber(value, 100);
    } else if (key == "firstLayerHeightPercentage") {
        if (const auto share = positiveNumber(value, 1000)) first_share_ = *share / 100;
    }
}

// Of more than four corners each four are a rectangle, as the slicer's own plate has them.
void StatedReader::setExcluded(std::string_view areas) {
    facts_.excluded.clear();
    const std::vector<std::array<double, 2>> corners = cornersOf(areas);
    if (corners.size() < 3) return;
    const std::size_t each = corners.size() % 4 == 0 ? 4 : corners.size();
    for (auto first = corners.begin(); first != corners.end(); first += static_cast<std::ptrdiff_t>(each))
        facts_.excluded.emplace_back(first, first + static_cast<std::ptrdiff_t>(each));
}

// Of a rectangle from the origin.
void StatedReader::setBedSide(std::size_t axis, std::string_view length) {
    const auto side = positiveNumber(length, kWidest);
    if (!side) return;
    bed_sides_[axis] = *side;
    const auto [x, y] = bed_sides_;
    if (x > 0 && y > 0) facts_.bed = {{0, 0}, {x, 0}, {x, y}, {0, y}};
}

void StatedReader::setMaterial(std::size_t tool, std::string_view name) {
    if (name.empty()) return;
    if (facts_.materials.size() <= tool) facts_.materials.resize(tool + 1);
    facts_.materials[tool] = name;
}

void StatedReader::setNumbers(std::string_view list, double most, std::vector<double>& numbers) {
    numbers.clear();
    split(list, ",;|",
          [&](std::size_t, std::string_view text) { numbers.push_back(positiveNumber(text, most).value_or(0)); });
}

void StatedReader::setNozzle(std::size_t tool, std::string_view diameter) {
    const auto size = positiveNumber(diameter, 100);
    if (!size) return;
    if (facts_.nozzle_diameters.size() <= tool) facts_.nozzle_diameters.resize(tool + 1);
    facts_.nozzle_diameters[tool] = *size;
}

StatedFacts StatedReader::finish() {
    // Written by CuraEngine alone, without Cura to fill in the time that the layers sum up to.
    constexpr double kPlaceholder = 6666;
    if (facts_.seconds == kPlaceholder) facts_.seconds = elapsed_;
    if (facts_.seconds == 0) facts_.seconds.reset();  // FullControl's head, which is like Cura's
    if (facts_.printer.empty()) facts_.printer = profile_;
    if (!facts_.first_layer_height && first_share_ && facts_.layer_height)
        facts_.first_layer_height = *first_share_ * *facts_.layer_height;
    return std::move(facts_);
}

}  // namespace stratum::gcode
