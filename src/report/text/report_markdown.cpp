#include "report/text/number_text.h"
#include "report/text/report_file.h"

#include <fmt/format.h>

namespace stratum::report {
namespace {

// In a cell of a table.
std::string cell(std::string text) {
    std::string out;
    for (const char c : text) {
        if (c == '|') out += '\\';
        if (c == '\n')
            out += "<br>";
        else
            out += c;
    }
    return out;
}

void addToolRows(const PrintReport& report, std::string& text) {
    text +=
        "| tool | material | filament, m | volume, mm³ | density, g/cm³ | price of a kg |\n|---|---|---|---|---|---|\n";
    for (const ToolUse& use : report.tools)
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} |\n", use.tool, use.material.empty() ? "-" : cell(use.material),
                        shortNumber(1e-3 * use.filament_mm), shortNumber(use.volume_mm3),
                        use.density ? shortNumber(*use.density) : "-", use.price ? shortNumber(*use.price) : "-");
    text += '\n';
}

template <typename Place>
void addColumns(const std::vector<Column>& columns, const Place& place, std::string& text) {
    for (const Column& column : columns) {
        const ColumnRange range = rangeOf(column);
        if (!range.any) continue;
        text += fmt::format("| {} | {} | {} ({}) | {} | {} ({}) | {} |\n", column.definition->title,
                            column.definition->unit, shortNumber(range.least), place(range.least_at),
                            shortNumber(range.mean), shortNumber(range.largest), place(range.largest_at),
                            column.definition->text);
    }
}

}  // namespace

std::string reportMarkdown(const PrintReport& report) {
    std::string text =
        fmt::format("# {}\n\n{}\n\n", report.source.empty() ? "Print report" : report.source, describePrint(report));
    for (const Section& section : sectionsOf(report)) {
        text += fmt::format("## {}\n\n| number | value | definition |\n|---|---|---|\n", section.title);
        for (const Number* number : section.numbers) {
            const std::string details = describeDetails(*number);
            text += fmt::format("| {} | {}{} | {} |\n", number->definition->title, cell(describeValue(*number)),
                                details.empty() ? "" : " (" + details + ")", number->definition->text);
        }
        for (const LeftOut* one : section.left_out)
            text += fmt::format("| {} | not told: {}; {} | {} |\n", one->definition->title, cell(one->why), one->remedy,
                                one->definition->text);
        text += '\n';
        if (section.title == numberDefinitions().front().section) addToolRows(report, text);
    }
    text += "## By layer\n\n| quantity | unit | least | mean | largest | definition |\n|---|---|---|---|---|---|\n";
    addColumns(
        report.by_layer, [&](std::size_t n) { return fmt::format("layer {}", report.layers.at(n)); }, text);
    addColumns(
        report.by_slab, [&](std::size_t n) { return fmt::format("z {} mm", shortNumber(report.slabs.at(n).second)); },
        text);
    return text + fmt::format("\nstratum {}. The values of all layers are in the .json.\n", STRATUM_VERSION);
}

}  // namespace stratum::report
