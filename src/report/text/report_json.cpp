#include "report/print_report.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace stratum::report {
namespace {

using Json = nlohmann::ordered_json;

// Seven digits: more than any of the numbers has.
double rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.7g", value);
    return std::strtod(text, nullptr);
}

Json valueOf(double value) { return std::isfinite(value) ? Json(rounded(value)) : Json(nullptr); }
Json valueOf(const Vector3& value) { return {valueOf(value[0]), valueOf(value[1]), valueOf(value[2])}; }
Json valueOf(const Matrix3& value) { return {valueOf(value[0]), valueOf(value[1]), valueOf(value[2])}; }

Json columnsOf(const std::vector<Column>& columns) {
    Json all = Json::object();
    for (const Column& column : columns) {
        Json values = Json::array();
        for (const double value : column.values) values.push_back(valueOf(value));
        all[std::string(column.definition->key)] = {{"title", column.definition->title},
                                                    {"unit", column.definition->unit},
                                                    {"definition", column.definition->text},
                                                    {"values", std::move(values)}};
    }
    return all;
}

Json toolsOf(const PrintReport& report) {
    Json tools = Json::array();
    for (const ToolUse& use : report.tools) {
        Json tool = {{"tool", use.tool},
                     {"material", use.material},
                     {"filament_mm", rounded(use.filament_mm)},
                     {"volume_mm3", rounded(use.volume_mm3)},
                     {"density_g_cm3", nullptr},
                     {"price_per_kg", nullptr}};
        if (use.density) tool["density_g_cm3"] = *use.density;
        if (use.price) tool["price_per_kg"] = *use.price;
        tools.push_back(std::move(tool));
    }
    return tools;
}

}  // namespace

Json toJson(const PrintReport& report) {
    Json numbers = Json::object();
    for (const Number& number : report.numbers) {
        Json entry = {{"title", number.definition->title},
                      {"value", std::visit([](const auto& value) { return valueOf(value); }, number.value)},
                      {"unit", number.definition->unit},
                      {"definition", number.definition->text}};
        for (const auto& [key, detail] : number.details)
            entry[key] = std::visit([](const auto& value) { return valueOf(value); }, detail);
        numbers[std::string(number.definition->key)] = std::move(entry);
    }
    Json left_out = Json::array();
    for (const LeftOut& one : report.left_out)
        left_out.push_back({{"number", one.definition->key},
                            {"title", one.definition->title},
                            {"why", one.why},
                            {"remedy", one.remedy}});
    Json from = Json::array();
    Json to = Json::array();
    for (const auto& [low, high] : report.slabs) {
        from.push_back(rounded(low));
        to.push_back(rounded(high));
    }
    return {{"print",
             {{"program", "stratum " STRATUM_VERSION},
              {"source", report.source},
              {"selection", report.selection},
              {"slicer", report.slicer},
              {"beads", report.bead_model},
              {"voxel_size_mm", report.voxel_mm},
              {"layer_height_mm", rounded(report.layer_height_mm)},
              {"interior", report.culled ? "cull" : "keep"}}},
            {"numbers", std::move(numbers)},
            {"tools", toolsOf(report)},
            {"by_layer", {{"layer", report.layers}, {"columns", columnsOf(report.by_layer)}}},
            {"by_height",
             {{"one_a_layer", report.slabs_are_layers},
              {"from_mm", std::move(from)},
              {"to_mm", std::move(to)},
              {"columns", columnsOf(report.by_slab)}}},
            {"left_out", std::move(left_out)}};
}

}  // namespace stratum::report
