#include "study/seed_print_rows.h"

#include "study/svg_plot.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace stratum::study {
namespace {

// What rendering takes with the thesis's number of samples: it grows with them.
double renderSeconds(const Row& row) { return seedValue(row, kRender) * kSeedSamples / seedValue(row, kSpp); }
double total(const Row& row) { return seedValue(row, kConvert) + seedValue(row, kBuild) + renderSeconds(row); }

bool exactEnough(const Row& row) { return seedValue(row, kBias) < seedValue(row, kNoise); }

std::string orNothing(double v, const char* format) {
    return std::isfinite(v) ? fmt::format(fmt::runtime(format), v) : "-";
}

void addEverything(Page& page, const std::vector<SeedPrintResult>& results) {
    std::vector<Row> cells;
    for (const SeedPrintResult& r : results)
        for (const Row& row : r.rows)
            cells.push_back({r.name, seedClassOf(r.enclosed), fmt::format("{:.1f}", r.enclosed),
                             fmt::format("{:.1f}", seedValue(row, kExtruded)), row[kKind], row[kPrimitives],
                             fmt::format("{:.1f}", seedValue(row, kBytes) * 1e-6),
                             fmt::format("{:.0f}", seedValue(row, kPeak) * 1e-6),
                             fmt::format("{:.2f}", seedValue(row, kConvert)),
                             fmt::format("{:.2f}", seedValue(row, kBuild)), fmt::format("{:.1f}", renderSeconds(row)),
                             fmt::format("{:.1f}", total(row)),
                             fmt::format("{:.2f}", seedValue(row, kRays) / seedValue(row, kRender) * 1e-6),
                             orNothing(seedValue(row, kNoise), "{:.2e}"), orNothing(seedValue(row, kBias), "{:.2e}"),
                             orNothing(seedValue(row, kSeries), "{:.2f}")});
    page.table({"print", "class", "cm\u00b3 enclosed", "cm\u00b3 extruded", "as", "primitives", "MB", "peak MB",
                "convert s", "build s", "render s", "total s", "Mrays/CPU s", "noise", "bias", "series s"},
               cells);
}

void addVerdict(Page& page, const std::vector<SeedPrintResult>& results, StudyReport& report) {
    std::vector<Row> cells;
    int large = 0;
    int reached = 0;
    for (const SeedPrintResult& r : results) {
        const Row* own = r.best(true);
        const Row* peer = r.best(false);
        if (own == nullptr || peer == nullptr) continue;
        const double ratio = total(*peer) / total(*own);
        const double own_ready = seedValue(*own, kConvert) + seedValue(*own, kBuild);
        const double peer_ready = seedValue(*peer, kConvert) + seedValue(*peer, kBuild);
        // Time is what it takes to be ready, and so much for each sample: where do the lines cross?
        const double own_sample = seedValue(*own, kRender) / seedValue(*own, kSpp);
        const double peer_sample = seedValue(*peer, kRender) / seedValue(*peer, kSpp);
        const double crossing = (own_ready - peer_ready) / (peer_sample - own_sample);
        const bool below = exactEnough(*own);
        const bool counts = r.enclosed >= 100;
        const bool ok = ratio >= 1.5 && below;
        large += counts ? 1 : 0;
        reached += counts && ok ? 1 : 0;
        const bool faster_rays = own_sample < peer_sample;
        std::string where = own_ready < peer_ready
                                ? (faster_rays ? "always" : fmt::format("below {:.0f} spp", crossing))
                                : (faster_rays ? fmt::format("above {:.0f} spp", crossing) : "never");
        cells.push_back({r.name, fmt::format("{:.1f}", r.enclosed), (*own)[kKind], (*peer)[kKind],
                         fmt::format("{:.2f}", ratio), fmt::format("{:.2f}", peer_sample / own_sample),
                         std::move(where), below ? "yes" : "no", counts ? (ok ? "reached" : "not reached") : "-"});
    }
    if (cells.empty()) return;
    page.heading("Level set against the best peer");
    page.paragraph(
        "The fastest level set and the fastest peer, of those whose bias is below the noise of the picture (the "
        "fastest of all if none is): total CPU time (convert, build, render at 32 spp) of the peer by the level set's; "
        "the same of a sample alone; from which number of samples on the level set is ahead. The aim, for 100 "
        "cm\u00b3 and more: 1.5 times faster, bias below the noise.");
    page.table({"print", "cm\u00b3", "level set", "best peer", "total, times", "a sample, times", "level set is ahead",
                "bias below noise", "aim"},
               cells, "not reached");
    report.findings.push_back(
        fmt::format("level set at least 1.5 times faster than the best peer, bias below noise: "
                    "{} of {} prints of 100 cm\u00b3 and more",
                    reached, large));
    page.paragraph(fmt::format("Of {} prints of 100 cm\u00b3 and more, {} reach the aim.", large, reached));
}

void addPlots(Page& page, const std::vector<SeedPrintResult>& results, const std::vector<std::string>& kinds) {
    Plot times{"Total time at 32 spp", "cm\u00b3 enclosed", "CPU seconds", true, true, {}};
    Plot ready{"Ready for rays (convert and build)", "cm\u00b3 enclosed", "CPU seconds", true, true, {}};
    Plot memory{"Memory that rays need", "cm\u00b3 enclosed", "MB", true, true, {}};
    for (const std::string& kind : kinds) {
        Series t{kind, {}, false, false};
        Series b = t;
        Series m = t;
        for (const SeedPrintResult& r : results) {
            const Row* row = r.find(kind);
            if (row == nullptr) continue;
            t.points.emplace_back(r.enclosed, total(*row));
            b.points.emplace_back(r.enclosed, seedValue(*row, kConvert) + seedValue(*row, kBuild));
            m.points.emplace_back(r.enclosed, seedValue(*row, kBytes) * 1e-6);
        }
        if (t.points.empty()) continue;
        times.series.push_back(std::move(t));
        ready.series.push_back(std::move(b));
        memory.series.push_back(std::move(m));
    }
    page.plot(times);
    page.plot(ready);
    page.plot(memory);
}

void addSplits(Page& page, const std::vector<SeedPrintResult>& results) {
    for (const SeedPrintResult& r : results) {
        if (r.sweep.empty()) continue;
        Plot plot{fmt::format("Segments cut at a largest length : width, {}", r.name),
                  "largest length : width (128: whole)",
                  "CPU seconds",
                  true,
                  true,
                  {}};
        for (const char* kind : {"beads", "4-gons"}) {
            Series ready{fmt::format("{}, build", kind), {}, true};
            Series render{fmt::format("{}, render", kind), {}};
            for (const Row& row : r.sweep) {
                if (!row[kKind].starts_with(kind)) continue;
                const std::string ratio = row[kKind].substr(row[kKind].find(' ') + 1);
                const double x = ratio == "whole" ? 128 : std::atof(ratio.c_str());
                ready.points.emplace_back(x, seedValue(row, kBuild));
                render.points.emplace_back(x, seedValue(row, kRender));
            }
            plot.series.push_back(std::move(ready));
            plot.series.push_back(std::move(render));
        }
        page.plot(plot);
    }
}

}  // namespace

double seedValue(const Row& row, SeedPrintColumn column) {
    return row[column].empty() ? std::numeric_limits<double>::quiet_NaN() : std::atof(row[column].c_str());
}

const char* seedClassOf(double cm3) { return cm3 < 30 ? "small" : cm3 < 300 ? "middle" : "large"; }

const Row* SeedPrintResult::find(const std::string& kind) const {
    for (const Row& row : rows)
        if (row[kKind] == kind) return &row;
    return nullptr;
}

const Row* SeedPrintResult::best(bool level_sets) const {
    const Row* least = nullptr;
    for (const Row& row : rows) {
        if (row[kKind].starts_with(kLevelSet) != level_sets) continue;
        const bool better = least == nullptr ||
                            std::pair(!exactEnough(row), total(row)) < std::pair(!exactEnough(*least), total(*least));
        if (better) least = &row;
    }
    return least;
}

void addSeedPrints(Page& page, const std::vector<SeedPrintResult>& results, const std::vector<std::string>& kinds,
                   StudyReport& report) {
    addPlots(page, results, kinds);
    addVerdict(page, results, report);
    addSplits(page, results);
    page.heading("Everything measured of prints");
    addEverything(page, results);
}

}  // namespace stratum::study
