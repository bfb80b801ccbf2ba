#include "report/text/html_page.h"
#include "report/text/number_text.h"
#include "report/text/report_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stratum::report {
namespace {

void addNumber(const Number& number, std::string& page) {
    const bool tensor = std::holds_alternative<Matrix3>(number.value);
    const std::string details = describeDetails(number);
    page += fmt::format("<div><dt>{}</dt><dd class='v{}'>{}</dd>", escapeMarkup(number.definition->title),
                        tensor ? " t" : "", escapeMarkup(describeValue(number)));
    if (!details.empty()) page += fmt::format("<dd class='m'>{}</dd>", escapeMarkup(details));
    page += fmt::format("<dd class='soft'>{}</dd></div>\n", escapeMarkup(number.definition->text));
}

void addLeftOut(const LeftOut& one, std::string& page) {
    page +=
        fmt::format("<div><dt>{}</dt><dd class='m out'>Not told: {}. Remedy: {}.</dd><dd class='soft'>{}</dd></div>\n",
                    escapeMarkup(one.definition->title), escapeMarkup(one.why), escapeMarkup(one.remedy),
                    escapeMarkup(one.definition->text));
}

void addToolTable(const PrintReport& report, std::string& page) {
    page +=
        "<div class='scroll'><table><tr><th>tool</th><th>material</th><th>filament, m</th><th>volume, mm³</th>"
        "<th>density, g/cm³</th><th>price of a kg</th></tr>\n";
    for (const ToolUse& use : report.tools)
        page += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", use.tool,
                            use.material.empty() ? "-" : escapeMarkup(use.material),
                            shortNumber(1e-3 * use.filament_mm), shortNumber(use.volume_mm3),
                            use.density ? shortNumber(*use.density) : "-", use.price ? shortNumber(*use.price) : "-");
    page += "</table></div>\n";
}

// At most kPoints points: of runs of layers the least and the largest, in their order, so that no peak is lost.
std::vector<std::pair<double, double>> thinned(const std::vector<double>& x, const std::vector<double>& y) {
    constexpr std::size_t kPoints = 800;
    std::vector<std::pair<double, double>> points;
    if (y.size() <= kPoints) {
        for (std::size_t n = 0; n < y.size(); ++n) points.emplace_back(x[n], y[n]);
        return points;
    }
    constexpr std::size_t kRuns = kPoints / 2;
    for (std::size_t run = 0; run < kRuns; ++run) {
        const std::size_t first = y.size() * run / kRuns;
        const std::size_t last = y.size() * (run + 1) / kRuns;
        std::size_t low = last;
        std::size_t high = last;
        for (std::size_t n = first; n < last; ++n) {
            if (!std::isfinite(y[n])) continue;
            if (low == last || y[n] < y[low]) low = n;
            if (high == last || y[n] > y[high]) high = n;
        }
        if (low == last) continue;
        points.emplace_back(x[std::min(low, high)], y[std::min(low, high)]);
        if (low != high) points.emplace_back(x[std::max(low, high)], y[std::max(low, high)]);
    }
    return points;
}

struct Chart {
    const char* title;
    const char* unit;
    std::vector<std::string_view> columns;
};

void addChart(const Chart& chart, const std::vector<Column>& columns, const std::vector<double>& x, const char* x_label,
              std::string& page) {
    Plot plot{chart.title, x_label, chart.unit, false, false, {}, true};
    std::string caption;
    for (const std::string_view key : chart.columns)
        for (const Column& column : columns) {
            if (column.definition->key != key || !rangeOf(column).any) continue;
            Series series{std::string(column.definition->title), thinned(x, column.values)};
            series.marked = x.size() < 2;
            plot.series.push_back(std::move(series));
            caption +=
                fmt::format("{}{}: {}", caption.empty() ? "" : " ", column.definition->title, column.definition->text);
        }
    if (plot.series.empty()) return;
    page += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", drawSvg(plot), escapeMarkup(caption));
}

void addCharts(const PrintReport& report, std::string& page) {
    page += "<h2>By layer</h2>\n<div class='plots'>\n";
    std::vector<double> layers(report.layers.begin(), report.layers.end());
    std::vector<double> heights;
    for (const auto& [low, high] : report.slabs) heights.push_back(0.5 * (low + high));
    addChart({"Porosity", "%", {"porosity", "closed_porosity"}}, report.by_slab, heights, "z, mm", page);
    addChart({"Plastic", "mm³", {"plastic_volume"}}, report.by_slab, heights, "z, mm", page);
    addChart({"Bonding", "%", {"bonding", "touching"}}, report.by_layer, layers, "layer", page);
    addChart({"Unsupported", "mm²", {"unsupported", "overhang_45", "overhang_75"}}, report.by_layer, layers, "layer",
             page);
    addChart({"Deposited", "mm³", {"deposited_volume"}}, report.by_layer, layers, "layer", page);
    addChart({"Time", "s", {"time"}}, report.by_layer, layers, "layer", page);
    page += "</div>\n";
}

}  // namespace

std::string reportPage(const PrintReport& report) {
    std::string page = fmt::format("<p class='soft'>{}</p>\n", escapeMarkup(describePrint(report)));
    for (const Section& section : sectionsOf(report)) {
        page += fmt::format("<h2>{}</h2>\n<dl>\n", escapeMarkup(section.title));
        for (const Number* number : section.numbers) addNumber(*number, page);
        for (const LeftOut* one : section.left_out) addLeftOut(*one, page);
        page += "</dl>\n";
        if (section.title == numberDefinitions().front().section) addToolTable(report, page);
    }
    addCharts(report, page);
    page += fmt::format("<p class='soft'>stratum {}</p>\n", STRATUM_VERSION);
    return htmlPage(report.source.empty() ? "Print report" : report.source, page);
}

}  // namespace stratum::report
