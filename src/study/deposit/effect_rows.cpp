// What each effect costs: reading and building beside capsules, in turns.
#include "deposit/printer.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/deposit/deposit_parts.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include "base/error.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace stratum::study {
namespace {

const Row kEffectColumns{"print",        "sha256",        "beads_are",   "run_number",    "beads",
                         "read_seconds", "build_seconds", "cpu_seconds", "peak_rss_bytes"};
constexpr std::size_t kEffectKeys = 4;
enum EffectColumn : std::size_t {
    kEffectPrint,
    kEffectHash,
    kEffectModel,
    kEffectRun,
    kEffectBeads,
    kEffectRead,
    kEffectBuild,
    kEffectCpu,
    kEffectPeak
};

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

std::string effectCells(const std::string& print, const BeadModel& model, int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
    openvdb::initialize();
    gcode::Toolpath toolpath;
    const Times read = timesOf([&] { toolpath = readByModel(print, model).toolpath; });
    openvdb::FloatGrid::Ptr grid;
    const Times build = timesOf([&] {
        const auto beads = voxelize::selectBeads(toolpath, {});
        const voxelize::Lattice lattice = latticeOf(toolpath, beads, kEffectVoxels);
        grid = voxelize::voxelize(toolpath, beads, lattice);
    });
    return fmt::format("{},{:.5f},{:.5f},{:.5f}", toolpath.beads.size(), read.wall, build.wall, read.cpu + build.cpu);
}

double middleOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// Of all runs of a model: seconds, and what they are of capsules in the same run.
struct EffectTimes {
    std::vector<double> read, build, ratio;
    std::string beads, run;
    std::size_t line = 0;
};

EffectTimes effectTimes(const ResultTable& table, const Row& head, const char* model) {
    EffectTimes times;
    for (int run = 1;; ++run) {
        Row key = head;
        key.insert(key.end(), {model, std::to_string(run)});
        const Row* own = table.find(key);
        Row base_key = head;
        base_key.insert(base_key.end(), {kEffects.front().name, std::to_string(run)});
        const Row* base = table.find(base_key);
        if (own == nullptr || base == nullptr) return times;
        times.read.push_back(numberIn(*own, kEffectRead));
        times.build.push_back(numberIn(*own, kEffectBuild));
        times.ratio.push_back((times.read.back() + times.build.back()) /
                              (numberIn(*base, kEffectRead) + numberIn(*base, kEffectBuild)));
        times.beads = own->at(kEffectBeads);
        times.run = own->back();
        if (run == 1) times.line = table.lineOf(key);
    }
}

void writeEffects(Page& page, const ResultTable& table, const std::vector<Row>& heads, int repeats) {
    page.heading("What each effect costs");
    page.paragraph(fmt::format(
        "From the bytes of a file to the grid of {} voxels a layer, wall seconds, medians of {} runs; each run is a "
        "process of its own, and the effects take turns. The ratio is to capsules in the same run: median, least and "
        "largest.",
        kEffectVoxels, repeats));
    Plot plot{"Time to a grid beside capsules", "print", "ratio", false, false, {}};
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const BeadModel& model : kEffects) {
        Series series{model.name, {}, false, false};
        for (std::size_t n = 0; n < heads.size(); ++n) {
            const EffectTimes t = effectTimes(table, heads[n], model.name);
            if (t.ratio.empty()) continue;
            const auto [low, high] = std::minmax_element(t.ratio.begin(), t.ratio.end());
            series.points.emplace_back(static_cast<double>(n + 1), middleOf(t.ratio));
            series.bars.emplace_back(*low, *high);
            cells.push_back({heads[n][kEffectPrint], model.name, model.options, t.beads,
                             fmt::format("{:.4f}", middleOf(t.read)), fmt::format("{:.4f}", middleOf(t.build)),
                             fmt::format("{:.2f}", middleOf(t.ratio)), fmt::format("{:.2f} .. {:.2f}", *low, *high),
                             t.run});
            lines.push_back(t.line);
        }
        plot.series.push_back(std::move(series));
    }
    page.plot(plot);
    page.table(
        {"print", "beads are", "options", "beads", "read s", "build s", "of capsules", "least .. largest", "run"},
        cells, {}, lines, "deposit_cost");
}

}  // namespace

PartTable studyEffects(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    auto table = std::make_unique<ResultTable>(common, "deposit_cost.csv", kEffectColumns, kEffectKeys);
    const int repeats = options.repeats > 0 ? options.repeats : common.quick ? 2 : 7;
    std::vector<Row> heads;
    double done = 0;
    const double steps = static_cast<double>(options.prints.size()) * repeats;
    for (const std::string& print : options.prints) {
        heads.push_back({std::filesystem::path(print).filename().string(), shortHash(print)});
        for (int run = 1; run <= repeats; ++run) {
            for (const BeadModel& model : kEffects) {
                Row row = heads.back();
                row.insert(row.end(), {model.name, std::to_string(run)});
                if (table->find(row) != nullptr) continue;
                const Outcome outcome = inOwnProcess([&] { return effectCells(print, model, common.threads); });
                if (!outcome.failure.empty())
                    throw InputError(fmt::format("{}: {}: {}", print, model.name, outcome.failure));
                const Row cells = parseCsvLine(outcome.text);
                row.insert(row.end(), cells.begin(), cells.end());
                row.push_back(std::to_string(outcome.peak_rss_bytes));
                table->add(std::move(row));
            }
            if (common.progress) common.progress(++done / steps);
        }
    }
    if (!heads.empty()) writeEffects(page, *table, heads, repeats);
    return table;
}

}  // namespace stratum::study
