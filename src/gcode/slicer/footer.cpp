#include "gcode/slicer/footer.h"

#include "gcode/text/setting_text.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMostTools = 256;
const double kMostAmount = std::nextafter(1e9, 0.0);

// Numbers separated by commas, with or without a unit behind each, times `scale`. Empty if one is no amount.
std::vector<double> amounts(std::string_view text, double scale) {
    std::vector<double> values = numbersOf(text, 0, kMostAmount);
    for (double& value : values) value *= scale;
    return values;
}

// The number at the start of the text, which it removes; kMostTools if there is none.
std::size_t takeIndex(std::string_view& text) {
    const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
    if (digits == 0 || digits > 3) return kMostTools;
    std::size_t value = 0;
    for (const char c : text.substr(0, digits)) value = value * 10 + static_cast<std::size_t>(c - '0');
    text.remove_prefix(digits);
    return std::min(value, kMostTools);
}

void setLengths(std::string_view text, double scale, Footer& footer) {
    if (auto list = amounts(text, scale); !list.empty()) footer = {.length = std::move(list), .volume = {}};
}

void setAt(std::vector<double>& list, std::size_t tool, std::string_view text) {
    const std::vector<double> value = amounts(text, 1);
    if (value.empty()) return;
    if (list.size() <= tool) list.resize(tool + 1);
    list[tool] = value[0];
}

}  // namespace

bool readFooter(std::string_view text, Footer& footer) {
    // Slic3r states grams by the same words.
    if (text.starts_with("filament used =") && text.ends_with('g')) return true;
    if (takePrefix(text, "filament used [mm] =") || takePrefix(text, "filament used =") ||
        takePrefix(text, "Filament length:") || takePrefix(text, "--- filament used:")) {
        setLengths(text, 1, footer);
        return true;
    }
    if (takePrefix(text, "Filament used:")) {  // Cura: metres, or mm3 where its E is
        if (text.find("mm3") == std::string_view::npos)
            setLengths(text, 1000, footer);
        else
            footer = {.length = {}, .volume = amounts(text, 1)};
        return true;
    }
    if (takePrefix(text,
                   "total filament length [mm] :")) {  // BambuStudio lists those in use, so that the sum alone is sure
        const std::vector<double> list = amounts(text, 1);
        if (!list.empty()) footer = {.length = {std::accumulate(list.begin(), list.end(), 0.0)}, .volume = {}};
        return true;
    }
    if (takePrefix(text, "filament_length_m =")) {  // Slic3r 1.3.1
        setLengths(text, 1000, footer);
        return true;
    }
    if (takePrefix(text, "Ext ")) {  // KISSlicer: "Ext 1 =    53.49 mm  (0.378 cm^3)"
        const std::size_t number = takeIndex(text);
        if (number == 0 || number >= kMostTools || !takePrefix(text, " =")) return false;
        setAt(footer.length, number - 1, text);
        return true;
    }
    if (takePrefix(text, "EXTRUDER_TRAIN.")) {
        const std::size_t tool = takeIndex(text);
        if (tool < kMostTools && takePrefix(text, ".MATERIAL.VOLUME_USED:")) setAt(footer.volume, tool, text);
        return true;
    }
    if (takePrefix(text, "Material#")) {
        const std::size_t number = takeIndex(text);
        if (number == 0 || number >= kMostTools || !takePrefix(text, " Used:")) return false;
        setAt(footer.length, number - 1, text);
        return true;
    }
    return false;
}

}  // namespace stratum::gcode
