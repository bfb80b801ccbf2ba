// What each effect costs: reading and building beside capsules, in turns.
#include "deposit/printer.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/deposit/deposit_parts.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace stratum::study {
namespace {

constexpr const char* kEffectColumns =
    "print,sha256,beads_are,run_number,beads,read_seconds,build_seconds,cpu_seconds,peak_rss_bytes";
constexpr std::array<BeadModel, 6> kEffects{
    {{"capsule", "no option", [](gcode::ReadOptions&) {}},
     {"section", "--section 50%", [](gcode::ReadOptions& read) { deposit::parseSection("50%", read.deposit); }},
     {"settled", "--beads settled",
      [](gcode::ReadOptions& read) { read.deposit.beads = gcode::DepositModel::Beads::settled; }},
     {"flow", "--flow-lag 0.015 --pressure-advance 0",
      [](gcode::ReadOptions& read) {
          read.deposit.flow_lag = 0.015;
          read.deposit.pressure_advance = 0;
      }},
     {"sag", "--sag 2%", [](gcode::ReadOptions& read) { read.deposit.sag = 0.02; }},
     {"typical", "--printer typical", [](gcode::ReadOptions& read) { deposit::usePrinter("typical", read); }}}};

constexpr int kEffectVoxels = 2;  // a layer

// In a process of its own: the cells after the key.
Row effectCells(const std::string& print, const BeadModel& model) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    const Times read = timesOf([&] { toolpath = readByModel(print, model).toolpath; });
    const Times build = timesOf([&] {
        const auto beads = voxelize::selectBeads(toolpath, {});
        voxelize::voxelize(toolpath, beads, latticeOf(toolpath, beads, kEffectVoxels));
    });
    return figures({static_cast<double>(toolpath.beads.size()), read.wall, build.wall, read.cpu + build.cpu,
                    static_cast<double>(peakSoFar())});
}

// Of all runs of a print: seconds of a model, and what they are of capsules' in the same run.
Row effectSummary(const Table& table, const std::string& print, const BeadModel& model, Series& series) {
    std::vector<double> read;
    std::vector<double> build;
    std::vector<double> ratio;
    double capsules = 0;
    for (const Row& row : table.rows()) {
        if (row[0] != print) continue;
        const double seconds = table.number(row, "read_seconds") + table.number(row, "build_seconds");
        const std::string& name = table.text(row, "beads_are");
        if (name == kEffects.front().name) capsules = seconds;  // the first of its run
        if (name != model.name) continue;
        read.push_back(table.number(row, "read_seconds"));
        build.push_back(table.number(row, "build_seconds"));
        ratio.push_back(seconds / capsules);
    }
    const auto [low, high] = std::minmax_element(ratio.begin(), ratio.end());
    series.points.emplace_back(static_cast<double>(series.points.size() + 1), median(ratio));
    series.bars.emplace_back(*low, *high);
    return {print,
            model.name,
            model.options,
            fmt::format("{:.4f}", median(read)),
            fmt::format("{:.4f}", median(build)),
            fmt::format("{:.2f}", median(ratio)),
            fmt::format("{:.2f} .. {:.2f}", *low, *high)};
}

}  // namespace

Table studyEffects(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    Table table(kEffectColumns);
    const int repeats = options.repeats > 0 ? options.repeats : common.quick ? 2 : 7;
    double done = 0;
    for (const std::string& print : options.prints)
        for (int run = 1; run <= repeats; ++run) {
            for (const BeadModel& model : kEffects)
                table.add(joined({std::filesystem::path(print).filename().string(), shortHash(print), model.name,
                                  std::to_string(run)},
                                 rowInOwnProcess(fmt::format("{}: {}", print, model.name), common.threads,
                                                 [&] { return effectCells(print, model); })));
            if (common.progress) common.progress(++done / static_cast<double>(options.prints.size()) / repeats);
        }
    if (options.prints.empty()) return table;
    page.heading("What each effect costs");
    page.paragraph(fmt::format(
        "From the bytes of a file to the grid of {} voxels a layer, wall seconds, medians of {} runs; each run is a "
        "process of its own, and the effects take turns. The ratio is to capsules in the same run: median, least and "
        "largest.",
        kEffectVoxels, repeats));
    Plot plot{"Time to a grid beside capsules", "print", "ratio", false, false, {}};
    std::vector<Row> rows;
    for (const BeadModel& model : kEffects) {
        Series series{model.name, {}, false, false};
        for (const std::string& print : options.prints)
            rows.push_back(effectSummary(table, std::filesystem::path(print).filename().string(), model, series));
        plot.series.push_back(std::move(series));
    }
    page.plot(plot);
    page.table({"print", "beads are", "options", "read s", "build s", "of capsules", "least .. largest"}, rows);
    return table;
}

}  // namespace stratum::study
