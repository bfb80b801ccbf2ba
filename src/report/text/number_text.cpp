#include "report/text/number_text.h"

#include "gcode/toolpath/stated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::report {
namespace {

std::string withUnit(double value, std::string_view unit) {
    if (unit == "s") return gcode::describeDuration(value);
    if (unit == "mm^3" && std::abs(value) >= 1e4) return shortNumber(value * 1e-3) + " cm³";
    if (unit == "mm^2" && std::abs(value) >= 1e4) return shortNumber(value * 1e-2) + " cm²";
    if (unit == "mm" && std::abs(value) >= 1e4) return shortNumber(value * 1e-3) + " m";
    if (unit == "um") return shortNumber(value) + " µm";
    if (unit == "mm^3") return shortNumber(value) + " mm³";
    if (unit == "mm^2") return shortNumber(value) + " mm²";
    return shortNumber(value) + (unit.empty() ? "" : " ") + std::string(unit);
}

std::string prettyUnit(std::string_view unit) {
    if (unit == "g mm^2") return "g mm²";
    if (unit == "mm^5") return "mm⁵";
    return std::string(unit);
}

std::string describeVector(const Vector3& v) { return fmt::format("({:.3f}, {:.3f}, {:.3f})", v[0], v[1], v[2]); }

}  // namespace

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "-";
    const double size = std::abs(value);
    if (size >= 1e7) return fmt::format("{:.4g}", value);
    if (size >= 1000) return fmt::format("{:.0f}", value);
    if (size >= 100) return fmt::format("{:.1f}", value);
    if (size >= 10) return fmt::format("{:.2f}", value);
    if (size >= 0.01) return fmt::format("{:.3f}", value);
    return fmt::format("{:.3g}", value);
}

std::string describeValue(const Number& number) {
    const std::string_view unit = number.definition->unit;
    if (const auto* value = std::get_if<double>(&number.value)) return withUnit(*value, unit);
    if (const auto* vector = std::get_if<Vector3>(&number.value))
        return describeVector(*vector) + " " + prettyUnit(unit);
    std::string text;
    for (const Vector3& row : std::get<Matrix3>(number.value))
        text += fmt::format("[{}, {}, {}]\n", shortNumber(row[0]), shortNumber(row[1]), shortNumber(row[2]));
    return text + prettyUnit(unit);
}

std::string describeDetails(const Number& number) {
    std::string text;
    for (const auto& [key, detail] : number.details) {
        std::string one;
        if (const auto* vector = std::get_if<Vector3>(&detail)) {
            one = fmt::format("at {} mm", describeVector(*vector));
        } else {
            const double value = std::get<double>(detail);
            if (key == "layer")
                one = fmt::format("layer {:.0f}", value);
            else if (key == "line")
                one = fmt::format("line {:.0f} of the file", value);
            else if (key == "lines")
                one = fmt::format("{:.0f} lines", value);
            else if (key == "measured")
                one = fmt::format("{:.0f} beads measured", value);
            else if (key == "least" || key == "largest")
                one = fmt::format("{} {}", key, shortNumber(value));
            else if (key == "share_of_level_beads" && value < 0.9995)
                one = fmt::format("of level beads, {:.1f} % of all", 100 * value);
            else
                continue;
        }
        text += (text.empty() ? "" : ", ") + one;
    }
    return text;
}

ColumnRange rangeOf(const Column& column) {
    ColumnRange range;
    range.least = std::numeric_limits<double>::max();
    range.largest = std::numeric_limits<double>::lowest();
    std::size_t count = 0;
    for (std::size_t n = 0; n < column.values.size(); ++n) {
        const double value = column.values[n];
        if (!std::isfinite(value)) continue;
        ++count;
        range.mean += value;
        if (value < range.least) range.least = value, range.least_at = n;
        if (value > range.largest) range.largest = value, range.largest_at = n;
    }
    range.any = count > 0;
    if (range.any) range.mean /= static_cast<double>(count);
    return range;
}

std::vector<Section> sectionsOf(const PrintReport& report) {
    std::vector<Section> sections;
    for (const Definition& definition : numberDefinitions()) {
        if (sections.empty() || sections.back().title != definition.section)
            sections.push_back({definition.section, {}, {}});
        for (const Number& number : report.numbers)
            if (number.definition == &definition) sections.back().numbers.push_back(&number);
        for (const LeftOut& one : report.left_out)
            if (one.definition == &definition) sections.back().left_out.push_back(&one);
    }
    return sections;
}

std::string describePrint(const PrintReport& report) {
    return fmt::format("{}; beads: {}; voxels of {} mm, layers of {} mm{}{}",
                       report.slicer.empty() ? "unknown slicer" : report.slicer, report.bead_model,
                       shortNumber(report.voxel_mm), shortNumber(report.layer_height_mm),
                       report.culled ? "; what the outside can't reach is filled" : "",
                       report.selection.empty() ? "" : "; of it: " + report.selection);
}

}  // namespace stratum::report
