#include "gcode/slicer/settings.h"

#include "gcode/slicer/truncation.h"
#include "gcode/text/number.h"
#include "gcode/text/setting_text.h"
#include "gcode/toolpath/color.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stratum::gcode {
namespace {

// Because of thumbnails and Cura's SETTING_3 lines, settings can be this far from the ends.
constexpr std::size_t kSettingsReach = std::size_t{1} << 18;
constexpr double kFarthestNozzle = 1000;  // mm from the first one

std::optional<bool> flag(std::string_view text) {
    if (text == "1" || text == "true" || text == "True") return true;
    if (text == "0" || text == "false" || text == "False") return false;
    return std::nullopt;
}

// Diameters by tool, separated by any of `separators`. Empty if any entry is not a number.
std::vector<double> diameters(std::string_view text, std::string_view separators) {
    std::vector<double> values;
    while (!text.empty()) {
        const auto cut = std::min(text.find_first_of(separators), text.size());
        const auto value = positiveNumber(text.substr(0, cut), 100);
        if (!value) return {};
        values.push_back(*value);
        text.remove_prefix(std::min(cut + 1, text.size()));
    }
    return values;
}

// "#FF8000;#DB5182", with or without quotes; empty entries are unknown.
std::vector<std::optional<Rgb>> colors(std::string_view text) {
    std::vector<std::optional<Rgb>> values;
    for (const std::string_view part : partsOf(text, ";,")) values.push_back(parseColor(part));
    return values;
}

// "0x0,18x0": the nozzles' positions by tool.
std::vector<Point> offsets(std::string_view text) {
    std::vector<Point> values;
    bool any = false;
    for (const std::string_view one : partsOf(text, ",")) {
        Point point;
        const char* p = one.data();
        const char* const end = p + one.size();
        if (!parseNumber(p, end, point.x) || p == end || *p != 'x' || !parseNumber(++p, end, point.y)) return {};
        if (!(std::abs(point.x) <= kFarthestNozzle && std::abs(point.y) <= kFarthestNozzle)) return {};
        any = any || point.x != 0 || point.y != 0;
        values.push_back(point);
    }
    return any ? values : std::vector<Point>{};
}

// The firmware of a flavour's name. PrusaSlicer's and Slic3r's "reprap" means RepRap/Sprinter, Marlin's forebear;
// Cura's "RepRap" means RepRapFirmware and is handled where it is read.
Firmware firmwareOfFlavor(std::string_view flavor) {
    if (flavor == "klipper") return Firmware::klipper;
    if (flavor == "reprapfirmware") return Firmware::reprap;
    return Firmware::marlin;
}

// "PrusaSlicer 2.5.0+win64 on 2022-09-06" -> "PrusaSlicer 2.5.0+win64"
std::string_view upTo(std::string_view text, std::string_view stop) {
    return trimQuoted(text.substr(0, text.find(stop)));
}

class SettingsReader {
public:
    void comment(std::string_view text) {
        text = trimQuoted(text);
        stated_.comment(text);
        if (readFooter(text, settings.footer)) return;
        const auto setting = keyAndValue(text);
        if (setting && setting->first.find(' ') == std::string_view::npos)
            pair(setting->first, setting->second);
        else
            sentence(text);
    }

    // Skeinforge: "(<layerHeight> 0.3 </layerHeight>)".
    void markup(std::string_view text) {
        if (takePrefix(text, "<layerHeight>") || takePrefix(text, "<layerThickness>")) {
            settings.layer_height = positiveNumber(text, 100);
        } else if (takePrefix(text, "<edgeWidth>") || takePrefix(text, "<perimeterWidth>")) {
            settings.extrusion_width = positiveNumber(text, 100);
        } else if (text.starts_with("<creator>") || text.starts_with("<version>")) {
            name("Skeinforge");
        }
    }

    Settings finish() {
        // The filament's color is preferred; the extruder's is used in the slicer's own views only.
        std::vector<std::optional<Rgb>>& tools = settings.tool_colors;
        tools = std::move(filament_colors_);
        tools.resize(std::max(tools.size(), extruder_colors_.size()));
        for (std::size_t tool = 0; tool < extruder_colors_.size(); ++tool)
            if (!tools[tool]) tools[tool] = extruder_colors_[tool];
        while (!tools.empty() && !tools.back()) tools.pop_back();
        settings.stated = stated_.finish();
        return std::move(settings);
    }

    Settings settings;

private:
    StatedReader stated_;
    std::vector<std::optional<Rgb>> filament_colors_;
    std::vector<std::optional<Rgb>> extruder_colors_;

    void pair(std::string_view key, std::string_view value) {
        if (key == "filament_diameter") {
            if (auto list = diameters(value, ","); !list.empty()) settings.filament_diameters = std::move(list);
        } else if (key == "layer_height" || key == "sliceHeight" ||  // Kiri:Moto's
                   key == "layer_thickness_mm") {                    // KISSlicer's
            if (const auto height = positiveNumber(value, 100)) settings.layer_height = height;
        } else if (key == "use_relative_e_distances") {
            settings.relative_e = flag(value);
        } else if (key == "use_volumetric_e") {
            settings.volumetric_e = flag(value);
            settings.volumetric_reason = "the file's use_volumetric_e is 1";
        } else if (key == "single_extruder_multi_material") {
            settings.shared_nozzle = flag(value).value_or(false);
        } else if (key == "extruder_colour") {
            extruder_colors_ = colors(value);
        } else if (key == "filament_colour") {
            filament_colors_ = colors(value);
        } else if (key == "extruder_offset") {
            settings.tool_offsets = offsets(value);
        } else if (key == "nozzle_diameter") {
            settings.nozzle_diameter = positiveNumber(value, 100);
        } else if (key == "extrusion_width" || key == "line_width") {
            if (value.find('%') == std::string_view::npos) settings.extrusion_width = positiveNumber(value, 100);
        } else if (key == "gcode_flavor") {
            settings.firmware = firmwareOfFlavor(value);
            settings.firmware_reason = std::string("the file's gcode_flavor is ").append(value);
        }
    }

    void sentence(std::string_view text) {
        if (takePrefix(text, "generated by ") || takePrefix(text, "Generated by ") ||
            takePrefix(text, "G-Code generated by ")) {
            name(upTo(upTo(text, " on "), " (Build"));
        } else if (takePrefix(text, "Generated with ") || takePrefix(text, "GCode created with ") ||
                   text.starts_with("BambuStudio ") || text.starts_with("KISSlicer") || text.starts_with("CraftWare")) {
            name(upTo(text, " - "));
        } else if (takePrefix(text, "Sliced by ")) {
            name(upTo(text, ","));
        } else if (takePrefix(text, "GENERATOR.NAME:")) {
            name(text);
        } else if (takePrefix(text, "GENERATOR.VERSION:")) {
            if (!settings.slicer.empty() && settings.slicer.find(' ') == std::string::npos)
                settings.slicer.append(" ").append(text);
        } else if (takePrefix(text, "FLAVOR:")) {
            curaFlavor(text);
        } else if (takePrefix(text, "Layer height:") || takePrefix(text, "layerHeight,") ||
                   takePrefix(text, "layer_height:")) {
            if (const auto height = positiveNumber(text, 100)) settings.layer_height = height;
        } else if (takePrefix(text, "Filament Diameter #")) {
            const auto colon = text.find(':');
            const auto diameter =
                colon == std::string_view::npos ? std::nullopt : positiveNumber(text.substr(colon + 1), 100);
            if (diameter) settings.filament_diameters.push_back(*diameter);
        } else if (takePrefix(text, "relativeEdistances,")) {
            settings.relative_e = flag(text);
        } else if (takePrefix(text, "filamentDiameters,")) {
            if (auto list = diameters(text, "|"); !list.empty()) settings.filament_diameters = std::move(list);
        }
    }

    void name(std::string_view text) {
        if (settings.slicer.empty()) settings.slicer = text;
    }

    void curaFlavor(std::string_view flavor) {
        settings.firmware = flavor == "RepRap"        ? Firmware::reprap
                            : flavor == "Creality OS" ? Firmware::klipper  // Creality's own of Klipper
                                                      : Firmware::marlin;
        settings.firmware_reason = std::string("the file's FLAVOR is ").append(flavor);
        // With two of Cura's flavours E is in mm^3, which only the printer's settings state; M200 in the file overrides
        // it. Griffin (Ultimaker 3 and later) is not one of them.
        if (flavor != "UltiGCode" && flavor != "Marlin(Volumetric)") return;
        settings.volumetric_e = true;
        settings.volumetric_reason = std::string("the file's FLAVOR is ").append(flavor);
    }
};

void readComments(std::string_view part, SettingsReader& reader) {
    while (!part.empty()) {
        const auto end = std::min(part.find_first_of("\r\n"), part.size());
        if (part.front() == ';') reader.comment(part.substr(1, end - 1));
        if (part.front() == '(') reader.markup(part.substr(1, end - 1));
        part.remove_prefix(std::min(end + 1, part.size()));
    }
}

}  // namespace

Settings readSettings(std::string_view bytes) {
    SettingsReader reader;
    readComments(bytes.substr(0, kSettingsReach), reader);
    if (bytes.size() > kSettingsReach) {
        std::string_view tail = bytes.substr(std::max(kSettingsReach, bytes.size() - kSettingsReach));
        // The tail may start inside a line, which must not be taken for a comment.
        tail.remove_prefix(std::min(tail.find_first_of("\r\n"), tail.size()));
        readComments(tail, reader);
    }
    Settings settings = reader.finish();
    settings.extrusion = scanExtrusion(bytes);
    if (!settings.relative_e.value_or(false)) settings.extrusion.relative_after_g90 = fallsBackAfterG90(bytes);
    settings.cut_short = findCut(bytes, settings.slicer);
    return settings;
}

}  // namespace stratum::gcode
