#include "gcode/slicer/settings.h"

#include "base/error.h"
#include "gcode/slicer/cura.h"
#include "gcode/slicer/truncation.h"
#include "gcode/text/number.h"
#include "gcode/text/setting_text.h"
#include "gcode/toolpath/color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace stratum::gcode {
namespace {

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

// The corners of the bed that Cura's settings of the machine state; empty if they don't.
std::vector<std::array<double, 2>> curaBed(std::span<const CuraSetting> settings) {
    constexpr double kWidest = 1e5;  // mm
    double x = 0;
    double y = 0;
    bool centered = false;
    for (const auto& [extruder, key, value] : settings) {
        if (key == "machine_width") x = positiveNumber(value, kWidest).value_or(0);
        if (key == "machine_depth") y = positiveNumber(value, kWidest).value_or(0);
        if (key == "machine_center_is_zero") centered = value == "True";
    }
    if (!(x > 0 && y > 0)) return {};
    const double left = centered ? -x / 2 : 0;
    const double front = centered ? -y / 2 : 0;
    return {{left, front}, {left + x, front}, {left + x, front + y}, {left, front + y}};
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

// Whether the program is by PrusaSlicer before 2.4, which heeded machine limits for gcode_flavor marlin alone.
bool isOldPrusaSlicer(std::string_view slicer) {
    if (!takePrefix(slicer, "PrusaSlicer 2.")) return false;
    const auto minor = std::min(slicer.find_first_not_of("0123456789"), slicer.size());
    return minor == 1 && slicer[0] < '4';
}

class SettingsReader {
public:
    void comment(std::string_view text) {
        if (cura_.comment(text)) return;
        text = trimQuoted(text);
        stated_.comment(text);
        constexpr std::array<std::string_view, 3> kHead{"FLAVOR:", "TIME:", "Layer height:"};
        for (std::size_t n = 0; n < kHead.size(); ++n)
            if (text.starts_with(kHead[n])) cura_head_ |= 1U << n;
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
        settings.stated = stated_.finish();
        if (settings.slicer.empty() && cura_head_ == kCuraHead) name("Cura");
        takeColors();
        takeProfile();
        settings.slicer_limits.by_velocity = estimatesByVelocity(settings.slicer);
        settings.slicer_limits.ignores_settings = flavor_ != "marlin" && isOldPrusaSlicer(settings.slicer);
        return std::move(settings);
    }

    Settings settings;

private:
    StatedReader stated_;
    CuraProfile cura_;
    std::vector<std::optional<Rgb>> filament_colors_;
    std::vector<std::optional<Rgb>> extruder_colors_;
    bool config_block_ = false;  // of OrcaSlicer, BambuStudio and their kin
    std::string flavor_;         // gcode_flavor
    unsigned cura_head_ = 0;     // which lines of Cura's head have been seen, where its name is missing
    static constexpr unsigned kCuraHead = 7;

    void takeColors() {
        // The order of the slicer's own preview. The other list fills empty places.
        const bool filaments_first = config_block_ || settings.slicer.find("Orca") != std::string::npos ||
                                     settings.slicer.find("Bambu") != std::string::npos;
        std::vector<std::optional<Rgb>>& tools = settings.tool_colors;
        tools = std::move(filaments_first ? filament_colors_ : extruder_colors_);
        const auto& others = filaments_first ? extruder_colors_ : filament_colors_;
        tools.resize(std::max(tools.size(), others.size()));
        for (std::size_t tool = 0; tool < others.size(); ++tool)
            if (!tools[tool]) tools[tool] = others[tool];
        while (!tools.empty() && !tools.back()) tools.pop_back();
    }

    // Cura's profile and its name of the machine. What the program states elsewhere counts more.
    void takeProfile() {
        if (cura_.isCura15()) name("Cura 15 or before");
        if (cura_.isDamaged()) settings.damaged_part = "CURA_PROFILE_STRING";
        std::string machine = settings.stated.printer;
        const std::vector<CuraSetting> changed = cura_.settings();
        for (const auto& [extruder, key, value] : changed) {
            if (key == "machine_name" && !isCuraMachine(machine)) machine = value;
            if (key == "definition" && !extruder && !isCuraMachine(machine)) machine = value;
        }
        MachineLimits limits = curaLimits(machine);
        std::vector<double> diameters;
        limits.guessed = !isCuraMachine(machine);
        for (const auto& [extruder, key, value] : changed) {
            if (setCuraLimit(key, value, limits)) limits.guessed = false;
            if (key == "layer_height" && !settings.layer_height) settings.layer_height = positiveNumber(value, 100);
            takeDiameter(extruder, key, value, diameters);
        }
        if (settings.filament_diameters.empty() && !diameters.empty()) {
            // A tool without a diameter of its own has the first one's.
            std::replace(diameters.begin(), diameters.end(), 0.0, diameters.front());
            if (diameters.front() > 0) settings.filament_diameters = std::move(diameters);
        }
        if (settings.stated.bed.empty()) settings.stated.bed = curaBed(changed);
        const auto by = [this](std::string_view slicer) { return settings.slicer.find(slicer) != std::string::npos; };
        if (!by("Cura") && !by("Creality Print V")) return;
        settings.stated.programs_left_out = true;
        settings.slicer_limits.limits = limits;
        if (isCuraMachine(machine)) settings.slicer_limits.machine = "machine, " + machine;
    }

    // material_diameter of the print or of an extruder; Cura 15's filament_diameter, filament_diameter2, ...
    static void takeDiameter(std::optional<std::size_t> extruder, std::string_view key, std::string_view value,
                             std::vector<double>& diameters) {
        std::size_t tool = extruder.value_or(0);
        if (takePrefix(key, "filament_diameter")) {
            if (key.size() > 1) return;
            if (!key.empty()) tool = key[0] >= '2' && key[0] <= '9' ? static_cast<std::size_t>(key[0] - '1') : 0;
        } else if (key != "material_diameter") {
            return;
        }
        const auto diameter = positiveNumber(value, 100);
        if (!diameter) return;  // Cura 15 writes 0 for a tool that takes the first one's
        if (diameters.size() <= tool) diameters.resize(tool + 1);
        diameters[tool] = *diameter;
    }

    void pair(std::string_view key, std::string_view value) {
        if (key == "filament_diameter" || key == "fiber_dia_mm" ||  // the latter is KISSlicer's
            key == "filamentDiameter") {                            // MatterSlice's
            if (auto list = diameters(value, ","); !list.empty()) settings.filament_diameters = std::move(list);
        } else if (key == "layer_height" || key == "sliceHeight" ||  // Kiri:Moto's
                   key == "layer_thickness_mm" ||                    // KISSlicer's
                   key == "layerThickness") {                        // MatterSlice's
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
            settings.tool_offsets = parseToolOffsets(value).value_or(std::vector<Point>());
            const auto isZero = [](const Point& offset) { return offset.x == 0 && offset.y == 0; };
            if (std::ranges::all_of(settings.tool_offsets, isZero)) settings.tool_offsets.clear();
        } else if (key == "nozzle_diameter") {
            settings.nozzle_diameter = positiveNumber(value, 100);
        } else if (key == "extrusion_width" || key == "line_width" || key == "extrusionWidth") {
            if (value.find('%') == std::string_view::npos) settings.extrusion_width = positiveNumber(value, 100);
        } else if (key == "gcode_flavor") {
            flavor_ = value;
            settings.firmware = firmwareOfFlavor(value);
            settings.firmware_reason = std::string("the file's gcode_flavor is ").append(value);
        }
    }

    void sentence(std::string_view text) {
        if (text == "CONFIG_BLOCK_START") {
            config_block_ = true;
        } else if (text.starts_with("Creality Print GCode Generated")) {
            name("Creality Print");
        } else if (takePrefix(text, "Creality Print Version :")) {
            name("Creality Print");
            if (settings.slicer == "Creality Print") settings.slicer.append(" ").append(text);
        } else if (takePrefix(text, "generated by ") || takePrefix(text, "Generated by ") ||
                   takePrefix(text, "G-Code generated by ")) {
            name(upTo(upTo(text, " on "), " (Build"));
        } else if (text.starts_with("<IceSL")) {
            name("IceSL");
        } else if (takePrefix(text, "nozzle_diameter_mm_0 :")) {  // IceSL
            settings.nozzle_diameter = positiveNumber(text, 100);
        } else if (takePrefix(text, "Generated with ") || takePrefix(text, "GCode created with ") ||
                   text.starts_with("BambuStudio ") || text.starts_with("KISSlicer") || text.starts_with("CraftWare")) {
            name(upTo(text, " - "));
        } else if (takePrefix(text, "Sliced by ")) {
            name(upTo(text, ","));
        } else if (takePrefix(text, "Generated with: ") ||  // REALvision
                   takePrefix(text, "GENERATOR.NAME:")) {
            name(text);
        } else if (takePrefix(text, "GENERATOR.VERSION:")) {
            if (!settings.slicer.empty() && settings.slicer.find(' ') == std::string::npos)
                settings.slicer.append(" ").append(text);
        } else if (takePrefix(text, "FLAVOR:")) {
            curaFlavor(text);
        } else if (takePrefix(text, "Layer height:") || takePrefix(text, "Layer Height:") ||
                   takePrefix(text, "layerHeight,") || takePrefix(text, "layer_height:") ||
                   takePrefix(text, "z_layer_height_mm :")) {  // the last is IceSL's
            if (const auto height = positiveNumber(text, 100)) settings.layer_height = height;
        } else if (takePrefix(text, "Filament Diameter #")) {
            const auto colon = text.find(':');
            const auto diameter =
                colon == std::string_view::npos ? std::nullopt : positiveNumber(text.substr(colon + 1), 100);
            if (diameter) settings.filament_diameters.push_back(*diameter);
        } else if (takePrefix(text, "relativeEdistances,")) {
            settings.relative_e = flag(text);
        } else if (takePrefix(text, "filamentDiameters,") || takePrefix(text, "filamentDiameter,") ||
                   takePrefix(text, "Material Diameter:") || takePrefix(text, "filament_diameter:") ||
                   takePrefix(text, "filament_diameter_mm_0 :")) {
            // Simplify3D 4 and 3, Creality Print, BambuStudio's and OrcaSlicer's header, IceSL
            if (auto list = diameters(text, "|,"); !list.empty()) settings.filament_diameters = std::move(list);
        }
    }

    void name(std::string_view text) {
        if (settings.slicer.empty()) settings.slicer = text;
    }

    void curaFlavor(std::string_view flavor) {
        settings.firmware = flavor == "RepRap"        ? Firmware::reprap
                            : flavor == "Creality OS" ? Firmware::klipper  // Klipper of the K1 and its kin
                                                      : Firmware::marlin;
        settings.firmware_reason = std::string("the file's FLAVOR is ").append(flavor);
        // With two of Cura's flavours E is in mm^3, which only the printer's settings state; M200 in the file overrides
        // it. Griffin (Ultimaker 3 and later) is not one of them.
        if (flavor != "UltiGCode" && flavor != "Marlin(Volumetric)") return;
        settings.volumetric_e = true;
        settings.volumetric_reason = std::string("the file's FLAVOR is ").append(flavor);
    }
};

}  // namespace

bool estimatesByVelocity(std::string_view slicer) {
    return slicer.starts_with("OrcaSlicer 2") || slicer.starts_with("BambuStudio 02");
}

std::optional<std::vector<Point>> parseToolOffsets(std::string_view text) {
    std::vector<Point> values;
    for (const std::string_view one : partsOf(text, ",")) {
        Point point;
        const char* p = one.data();
        const char* const end = p + one.size();
        if (!parseNumber(p, end, point.x) || p == end || *p != 'x' || !parseNumber(++p, end, point.y) || p != end)
            return std::nullopt;
        if (!(std::abs(point.x) <= kFarthestNozzle && std::abs(point.y) <= kFarthestNozzle)) return std::nullopt;
        values.push_back(point);
    }
    if (values.empty()) return std::nullopt;
    return values;
}

std::vector<Point> toolOffsetsOf(const std::string& text, const std::string& option) {
    if (auto offsets = parseToolOffsets(text)) return *std::move(offsets);
    throw UsageError(fmt::format("{} {}: expected XxY in mm for each tool, at most {:g} mm, such as 0x0,18x0", option,
                                 text, kFarthestNozzle));
}

Settings readSettings(std::string_view bytes) {
    SettingsReader reader;
    forEachSettingsComment(bytes, [&reader](char mark, std::string_view text) {
        if (mark == ';')
            reader.comment(text);
        else
            reader.markup(text);
    });
    Settings settings = reader.finish();
    if (settings.slicer.starts_with("ideaMaker 4"))
        for (double& flow : settings.footer.flow) flow *= flow;  // its statement multiplies twice
    settings.extrusion = scanExtrusion(bytes);
    if (!settings.relative_e.value_or(false)) settings.extrusion.relative_after_g90 = fallsBackAfterG90(bytes);
    settings.cut_short = findCut(bytes, settings.slicer);
    return settings;
}

}  // namespace stratum::gcode
