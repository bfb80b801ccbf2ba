#include "convert/reports.h"

#include "gcode/summary.h"
#include "gcode/toolpath/color.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;

Json describeFeatures(const gcode::Toolpath& toolpath) {
    Json features = Json::object();
    const auto totals = gcode::featureTotals(toolpath);
    for (std::size_t i = 0; i < totals.size(); ++i)
        if (totals[i].beads > 0)
            features[std::string(gcode::featureName(static_cast<gcode::Feature>(i)))] = {
                {"beads", totals[i].beads}, {"length_mm", totals[i].length}, {"volume_mm3", totals[i].volume}};
    return features;
}

// What was read beside what the file says of itself; null where it says nothing.
Json describeTools(const gcode::Toolpath& toolpath) {
    Json tools = Json::array();
    for (std::size_t tool = 0; tool < toolpath.filament_by_tool.size(); ++tool) {
        if (!(toolpath.filament_by_tool[tool] > 0)) continue;
        Json entry = {{"tool", tool}, {"filament_mm", toolpath.filament_by_tool[tool]}, {"footer_mm", nullptr}};
        if (tool < toolpath.footer_by_tool.size()) entry["footer_mm"] = toolpath.footer_by_tool[tool];
        if (tool < toolpath.tool_colors.size() && toolpath.tool_colors[tool])
            entry["color"] = gcode::colorText(*toolpath.tool_colors[tool]);
        tools.push_back(std::move(entry));
    }
    return tools;
}

// Only what the file says; null where it says nothing of all this.
Json describeStated(const gcode::StatedFacts& stated) {
    Json facts = nullptr;
    const auto set = [&facts](const char* name, const auto& value) {
        if (value) facts[name] = *value;
    };
    set("seconds", stated.seconds);
    set("model_seconds", stated.model_seconds);
    set("grams", stated.grams);
    set("cost", stated.cost);
    if (!stated.materials.empty()) facts["materials"] = stated.materials;
    if (!stated.nozzle_diameters.empty()) facts["nozzle_diameters_mm"] = stated.nozzle_diameters;
    if (!stated.printer.empty()) facts["printer"] = stated.printer;
    set("layer_height_mm", stated.layer_height);
    set("first_layer_height_mm", stated.first_layer_height);
    return facts;
}

Json describeObjects(const gcode::Toolpath& toolpath) {
    const std::vector<gcode::FeatureTotal> totals = gcode::objectTotals(toolpath);
    Json objects = Json::array();
    for (std::size_t i = 1; i < totals.size(); ++i)
        objects.push_back({{"number", i},
                           {"name", toolpath.objects[i]},
                           {"beads", totals[i].beads},
                           {"length_mm", totals[i].length},
                           {"volume_mm3", totals[i].volume}});
    return objects;
}

}  // namespace

Json describeToolpath(const gcode::Toolpath& toolpath) {
    double length = 0;
    double volume = 0;
    for (const gcode::FeatureTotal& total : gcode::featureTotals(toolpath)) {
        length += total.length;
        volume += total.volume;
    }
    Json warnings = Json::array();
    for (const gcode::Warning& warning : toolpath.warnings)
        warnings.push_back({{"text", warning.text}, {"first_line", warning.first_line}, {"count", warning.count}});
    Json footer = nullptr;
    if (toolpath.footer_mm > 0) footer = toolpath.footer_mm;
    return {{"beads", toolpath.beads.size()},
            {"arcs", toolpath.arcs.size()},
            {"layers", toolpath.layer_count},
            {"length_mm", length},
            {"filament_mm", toolpath.filament_mm},
            {"prime_mm", toolpath.prime_mm},
            {"flushed_mm", toolpath.flushed_mm},
            {"primed_mm", toolpath.primed_mm},
            {"footer_mm", footer},
            {"filament_diameter_mm", toolpath.filament_diameter},
            {"volume_mm3", volume},
            {"extruded_mm3", toolpath.extruded_mm3},
            {"firmware", toolpath.firmware},
            {"firmware_reason", toolpath.firmware_reason},
            {"extrusion", toolpath.extrusion_rule},
            {"cut_short", toolpath.cut_short},
            {"stated", describeStated(toolpath.stated)},
            {"features", describeFeatures(toolpath)},
            {"tools", describeTools(toolpath)},
            {"objects", describeObjects(toolpath)},
            {"warnings", warnings}};
}

nlohmann::ordered_json describeFlow(const deposit::FlowReport& flow) {
    nlohmann::ordered_json told = {{"lag_s", flow.lag},
                                   {"longest_advance_s", flow.longest_advance},
                                   {"fed_mm3", flow.fed},
                                   {"laid_mm3", flow.laid},
                                   {"in_discs_mm3", flow.in_discs},
                                   {"purged_mm3", flow.purged},
                                   {"in_nozzle_mm3", flow.in_nozzle},
                                   {"beads_of_file", flow.beads},
                                   {"parts", flow.parts},
                                   {"discs", flow.discs}};
    if (flow.strings > 0)
        told["strings"] = {{"count", flow.strings}, {"length_mm", flow.strings_mm}, {"volume_mm3", flow.in_strings}};
    return told;
}

std::string flowLine(const deposit::FlowReport& flow) {
    std::string line = fmt::format(
        "flow with a lag of {:g} s: {:.2f} mm^3 fed, {:.2f} laid ({:.2f} at {} rests, {:.2f} purged elsewhere), {:.2f} "
        "left in the nozzle; {} beads became {} parts",
        flow.lag, flow.fed, flow.laid, flow.in_discs, flow.discs, flow.purged, flow.in_nozzle, flow.beads, flow.parts);
    if (flow.strings > 0)
        line += fmt::format("; {:.2f} in {} strings of {:.0f} mm", flow.in_strings, flow.strings, flow.strings_mm);
    return line;
}

nlohmann::ordered_json describeSag(const deposit::SagReport& sag) {
    return {{"spans", sag.spans}, {"length_mm", sag.length_mm}, {"deepest_mm", sag.deepest_mm}};
}

std::string sagLine(const deposit::SagReport& sag) {
    return fmt::format("sag: {} spans of {:.1f} mm in all hang, at most {:.2f} mm", sag.spans, sag.length_mm,
                       sag.deepest_mm);
}

}  // namespace stratum::tools
