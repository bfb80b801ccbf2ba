#include "gcode/summary.h"

#include "base/human_text.h"
#include "gcode/slicer/bead_colors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace stratum::gcode {
namespace {

void count(const Toolpath& toolpath, const Bead& bead, FeatureTotal& total) {
    ++total.beads;
    total.length += beadLength(toolpath, bead);
    total.volume += laidVolume(toolpath, static_cast<std::uint32_t>(&bead - toolpath.beads.data()));
}

void compare(double measured, double footer, fmt::memory_buffer& out) {
    fmt::format_to(std::back_inserter(out), "{:.2f} mm of filament", measured);
    if (footer > 0)
        fmt::format_to(std::back_inserter(out), "; the file says {:.2f} ({:+.2f} %)", footer,
                       100 * (measured - footer) / footer);
    out.push_back('\n');
}

// Of a list by tool, which may be short.
double at(const std::vector<double>& list, std::size_t tool) { return tool < list.size() ? list[tool] : 0.0; }

void describeFilament(const Toolpath& toolpath, fmt::memory_buffer& out) {
    const std::size_t tools = std::max(toolpath.filament_by_tool.size(), toolpath.footer_by_tool.size());
    // Some slicers count the prime lines of the start program, or what they push out in place, others don't: the
    // nearest sum is compared.
    const double footer = toolpath.footer_mm;
    double all = toolpath.filament_mm + toolpath.flushed_mm;
    const auto miss = [&](double sum) {
        return std::min(std::abs(sum - footer), std::abs(sum - toolpath.prime_mm - footer));
    };
    const bool primed = toolpath.primed_mm > 0 && footer > 0 && miss(all + toolpath.primed_mm) < miss(all);
    if (primed) all += toolpath.primed_mm;
    const double part = all - toolpath.prime_mm;
    const bool primes = toolpath.prime_mm > 0;
    const bool part_alone = primes && (!(footer > 0) || std::abs(part - footer) <= std::abs(all - footer));
    fmt::format_to(std::back_inserter(out), "E is {}\n{}: ", toolpath.extrusion_rule, part_alone ? "part" : "all");
    compare(part_alone ? part : all, footer, out);
    if (toolpath.flushed_mm > 0)
        fmt::format_to(std::back_inserter(out), "flushed while filaments change: {:.2f} mm, which are in that sum\n",
                       toolpath.flushed_mm);
    if (toolpath.primed_mm > 0.5)
        fmt::format_to(std::back_inserter(out), "pushed out in place between lines: {:.2f} mm, in no bead{}\n",
                       toolpath.primed_mm, primed ? ", but in that sum" : "");
    if (primes)
        fmt::format_to(std::back_inserter(out), "prime lines before layer 1: {:.2f} mm{}\n", toolpath.prime_mm,
                       part_alone ? "" : ", which are in that sum");
    if (tools == 1) return;
    for (std::size_t tool = 0; tool < tools; ++tool) {
        const double measured = at(toolpath.filament_by_tool, tool);
        const double of_tool = at(toolpath.footer_by_tool, tool);
        if (!(measured > 0) && !(of_tool > 0)) continue;
        fmt::format_to(std::back_inserter(out), "T{}: ", tool);
        compare(measured, of_tool, out);
    }
}

// Each once, those of the tools that print.
template <typename Value>
std::vector<Value> inUse(const std::vector<Value>& by_tool, const Toolpath& toolpath) {
    std::vector<Value> values;
    for (std::size_t tool = 0; tool < by_tool.size(); ++tool) {
        if (!(at(toolpath.filament_by_tool, tool) > 0) || by_tool[tool] == Value{}) continue;
        if (std::find(values.begin(), values.end(), by_tool[tool]) == values.end()) values.push_back(by_tool[tool]);
    }
    return values;
}

// One line of the file's statements, or none.
void describeStated(const Toolpath& toolpath, fmt::memory_buffer& out) {
    const StatedFacts& stated = toolpath.stated;
    std::vector<std::string> parts;
    if (stated.seconds) parts.push_back(describeDuration(*stated.seconds));
    if (stated.model_seconds)
        parts.push_back(fmt::format("{} of it for the model", describeDuration(*stated.model_seconds)));
    if (stated.grams) parts.push_back(fmt::format("{:g} g", *stated.grams));
    const auto materials = inUse(stated.materials, toolpath);
    if (!materials.empty()) parts.push_back(fmt::format("{}", fmt::join(materials, " and ")));
    const auto nozzles = inUse(stated.nozzle_diameters, toolpath);
    if (!nozzles.empty()) parts.push_back(fmt::format("nozzle {:g} mm", fmt::join(nozzles, " and ")));
    if (!stated.printer.empty()) parts.push_back(stated.printer);
    if (stated.layer_height) parts.push_back(fmt::format("layers of {:g} mm", *stated.layer_height));
    if (stated.first_layer_height) parts.push_back(fmt::format("the first {:g} mm", *stated.first_layer_height));
    if (!parts.empty()) fmt::format_to(std::back_inserter(out), "the file says: {}\n", fmt::join(parts, ", "));
}

// One line of the colors of the tools that print, as pictures show them, or none.
void describeColors(const Toolpath& toolpath, fmt::memory_buffer& out) {
    std::vector<std::string> parts;
    const auto add = [&](std::size_t tool, const Rgb& color, bool stated, const std::string& since) {
        parts.push_back(fmt::format("T{} {}{}{}", tool, colorText(color), stated ? "" : " (not stated)", since));
    };
    for (std::size_t tool = 0; tool < toolpath.tool_colors.size(); ++tool) {
        if (!toolpath.tool_colors[tool] || !(at(toolpath.filament_by_tool, tool) > 0)) continue;
        add(tool, *toolpath.tool_colors[tool], !colorOfTool(toolpath, static_cast<std::uint8_t>(tool)).palette, {});
    }
    for (const ColorChange& change : toolpath.color_changes) {
        if (change.first_bead >= toolpath.beads.size()) continue;
        const Run& run = toolpath.runOf(toolpath.beads[change.first_bead]);
        add(change.tool, change.color, change.stated, fmt::format(" from layer {} on", run.layer));
    }
    if (!parts.empty()) fmt::format_to(std::back_inserter(out), "colors: {}\n", fmt::join(parts, ", "));
}

}  // namespace

std::array<FeatureTotal, kFeatureCount> featureTotals(const Toolpath& toolpath) {
    std::array<FeatureTotal, kFeatureCount> totals{};
    for (const Bead& bead : toolpath.beads)
        count(toolpath, bead, totals[static_cast<std::size_t>(toolpath.runOf(bead).feature)]);
    return totals;
}

std::vector<FeatureTotal> objectTotals(const Toolpath& toolpath) {
    std::vector<FeatureTotal> totals(toolpath.objects.size());
    for (const Bead& bead : toolpath.beads) count(toolpath, bead, totals[toolpath.runOf(bead).object]);
    return totals;
}

std::vector<double> layerSeconds(const Toolpath& toolpath) {
    std::vector<double> layers(toolpath.layer_count + std::size_t{1}, 0.0);
    double before = toolpath.timing.empty() ? 0.0 : toolpath.timing.front().start;
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) {
        const Bead& bead = toolpath.beads[n];
        const double end = toolpath.timing.empty()
                               ? before + beadSeconds(toolpath, bead)
                               : toolpath.timing[n].start + static_cast<double>(toolpath.timing[n].seconds);
        layers[toolpath.runOf(bead).layer] += end - before;
        before = end;
    }
    return layers;
}

std::string summarize(const Toolpath& toolpath) {
    fmt::memory_buffer out;
    const auto totals = featureTotals(toolpath);
    double length = 0;
    for (const FeatureTotal& total : totals) length += total.length;
    describeStated(toolpath, out);
    fmt::format_to(std::back_inserter(out), "{} ({}), read by the rules of {}: {}\n",
                   toolpath.slicer.empty() ? "unknown slicer" : toolpath.slicer, toolpath.format, toolpath.firmware,
                   toolpath.firmware_reason);
    fmt::format_to(std::back_inserter(out), "{}, {}, {} of them arcs; {:.2f} m, {:.2f} mm^3\n",
                   counted(toolpath.layer_count, "layer"), counted(toolpath.beads.size(), "bead"), toolpath.arcs.size(),
                   length / 1000, toolpath.extruded_mm3);
    describeFilament(toolpath, out);
    describeColors(toolpath, out);
    for (std::size_t i = 0; i < totals.size(); ++i) {
        if (totals[i].beads == 0) continue;
        fmt::format_to(std::back_inserter(out), "  {:<20}{:>9} beads {:>10.2f} m {:>11.2f} mm^3\n",
                       featureName(static_cast<Feature>(i)), totals[i].beads, totals[i].length / 1000,
                       totals[i].volume);
    }
    if (toolpath.objects.size() > 1) {
        const auto objects = objectTotals(toolpath);
        for (std::size_t i = 1; i < objects.size(); ++i)
            fmt::format_to(std::back_inserter(out), "  object {}, {}: {}, {:.2f} mm^3\n", i, toolpath.objects[i],
                           counted(objects[i].beads, "bead"), objects[i].volume);
    }
    for (const Warning& warning : toolpath.warnings)
        fmt::format_to(std::back_inserter(out), "warning: line {}: {}{}\n", warning.first_line, warning.text,
                       warning.count > 1 ? fmt::format(" ({} times)", warning.count) : "");
    return fmt::to_string(out);
}

}  // namespace stratum::gcode
