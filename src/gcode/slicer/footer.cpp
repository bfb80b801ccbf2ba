#include "gcode/slicer/footer.h"

#include "gcode/text/setting_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>
#include <span>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMostTools = 256;
const double kMostAmount = std::nextafter(1e9, 0.0);

struct Unit {
    std::string_view name;
    double scale;  // to mm or mm^3
};
constexpr std::array kLengths{Unit{"mm", 1}, Unit{"cm", 10}, Unit{"m", 1000},
                              Unit{"meter", 1000}};  // the last is REALvision's
constexpr std::array kVolumes{Unit{"mm3", 1}, Unit{"mm^3", 1}, Unit{"cm3", 1000}, Unit{"cm^3", 1000}};

// The letters and digits that a text begins with, after blanks.
std::string_view wordOf(std::string_view text) {
    text = trim(text);
    const auto end = std::find_if(text.begin(), text.end(),
                                  [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '^'; });
    return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

// Numbers separated by commas, each with one of the units behind it, or without a unit times `scale`. Empty if one is
// no amount, or of something else: slicers state grams by the words of lengths.
std::vector<double> amounts(std::string_view text, double scale, std::span<const Unit> units) {
    std::vector<double> values;
    for (const std::string_view part : partsOf(text, ",")) {
        const char* p = part.data();
        double value = 0;
        if (!parseNumber(p, p + part.size(), value) || !(value >= 0 && value <= kMostAmount)) return {};
        const std::string_view word = wordOf(part.substr(static_cast<std::size_t>(p - part.data())));
        const auto unit = std::find_if(units.begin(), units.end(), [word](const Unit& u) { return u.name == word; });
        if (!word.empty() && unit == units.end()) return {};
        values.push_back(value * (word.empty() ? scale : unit->scale));
    }
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
    if (auto list = amounts(text, scale, kLengths); !list.empty())
        footer = {.length = std::move(list), .volume = {}, .flow = {}, .a_line_each = false};
}

// Slic3r up to 1.2.9: "277.2mm (1.8cm3)", a line for each tool. Slic3r PE 1.42 states grams by the same words, without
// a unit; so does MatterSlice its mm, but alone.
void addLine(std::string_view text, Footer& footer) {
    const std::vector<double> list = amounts(text, 1, kLengths);
    const bool bare = amounts(text, 0, kLengths) != list;
    if (bare && footer.a_line_each) return;
    if (list.size() != 1 || bare || !footer.a_line_each) {
        setLengths(text, 1, footer);
        footer.a_line_each = list.size() == 1 && !bare;
    } else if (footer.length.size() < kMostTools) {
        footer.length.push_back(list[0]);
    }
}

void setAt(std::vector<double>& list, std::size_t tool, std::string_view text, std::span<const Unit> units) {
    const std::vector<double> value = amounts(text, 1, units);
    if (value.empty()) return;
    if (list.size() <= tool) list.resize(tool + 1);
    list[tool] = value[0];
}

}  // namespace

bool readFooter(std::string_view text, Footer& footer) {
    if (takePrefix(text, "filament used =")) {
        addLine(text, footer);
        return true;
    }
    if (takePrefix(text, "filament used [mm] =") || takePrefix(text, "Filament length:") ||
        takePrefix(text, "--- filament used:") || takePrefix(text, "FilamentUsed:")) {  // the last is WEEDO's
        setLengths(text, 1, footer);
        return true;
    }
    if (takePrefix(text, "Filament used:")) {  // Cura: metres, or mm3 where its E is
        if (text.find("mm3") == std::string_view::npos)
            setLengths(text, 1000, footer);
        else
            footer = {.length = {}, .volume = amounts(text, 1, kVolumes), .flow = {}, .a_line_each = false};
        return true;
    }
    if (takePrefix(text,
                   "total filament length [mm] :")) {  // BambuStudio lists those in use, so that the sum alone is sure
        const std::vector<double> list = amounts(text, 1, kLengths);
        if (!list.empty())
            footer = {.length = {std::accumulate(list.begin(), list.end(), 0.0)},
                      .volume = {},
                      .flow = {},
                      .a_line_each = false};
        return true;
    }
    if (takePrefix(text, "filament_length_m =")) {  // Slic3r 1.3.1
        setLengths(text, 1000, footer);
        return true;
    }
    if (takePrefix(text, "Ext ")) {  // KISSlicer: "Ext 1 =    53.49 mm  (0.378 cm^3)"
        const std::size_t number = takeIndex(text);
        if (number == 0 || number >= kMostTools || !takePrefix(text, " =")) return false;
        setAt(footer.length, number - 1, text, kLengths);
        return true;
    }
    for (const std::size_t tool : {0U, 1U})  // Miracle-Grue
        if (takePrefix(text, tool == 0 ? "Right Toolhead Distance (mm):" : "Left Toolhead Distance (mm):")) {
            setAt(footer.length, tool, text, kLengths);
            return true;
        }
    if (takePrefix(text, "Estimated Build Volume:")) {  // KISSlicer 1.4 and before, which has no "Ext 1 ="
        if (footer.length.empty()) setAt(footer.volume, 0, text, kVolumes);
        return true;
    }
    if (takePrefix(text, "EXTRUDER_TRAIN.")) {
        const std::size_t tool = takeIndex(text);
        if (tool < kMostTools && takePrefix(text, ".MATERIAL.VOLUME_USED:")) setAt(footer.volume, tool, text, kVolumes);
        return true;
    }
    if (takePrefix(text, "Filament Compensation #")) {
        const std::size_t number = takeIndex(text);
        if (number == 0 || number >= kMostTools || !takePrefix(text, ":")) return false;
        const std::vector<double> percent = amounts(text, 0.01, {});
        if (footer.flow.size() < number) footer.flow.resize(number);
        if (!percent.empty()) footer.flow[number - 1] = percent[0];
        return true;
    }
    if (takePrefix(text, "Material#")) {
        const std::size_t number = takeIndex(text);
        if (number == 0 || number >= kMostTools || !takePrefix(text, " Used:")) return false;
        setAt(footer.length, number - 1, text, kLengths);
        return true;
    }
    return false;
}

}  // namespace stratum::gcode
