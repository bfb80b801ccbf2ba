#include "study/polygons/print_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace stratum::study {
namespace {

// What it takes until a picture is there: of the thesis's number of samples, in proportion to those that were rendered,
// or of one, as a first look measured it. NaN where none did.
double total(const Row& row, int spp, bool wall = false) {
    if (spp == 1) return valueOf(row, wall ? kFirstLookWall : kFirstLook);
    return valueOf(row, wall ? kConvertWall : kConvert) + valueOf(row, wall ? kBuildWall : kBuild) +
           valueOf(row, wall ? kRenderWall : kRender) * spp / valueOf(row, kSpp);
}
double sample(const Row& row) { return valueOf(row, kRender) / valueOf(row, kSpp); }

// The noise was measured with kComparedSamples; of fewer it is larger, at least in proportion.
bool exactEnough(const Row& row, int spp) {
    return valueOf(row, kBias) < valueOf(row, kNoise) * kComparedSamples / spp;
}

std::string orNothing(double v, const char* format) {
    return std::isfinite(v) ? fmt::format(fmt::runtime(format), v) : "-";
}

void addEverything(Page& page, const std::vector<PrintResult>& results) {
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const PrintResult& r : results) {
        lines.insert(lines.end(), r.lines.begin(), r.lines.end());
        for (const Row& row : r.rows)
            cells.push_back({r.name,
                             sizeClassOf(r.enclosed),
                             fmt::format("{:.1f}", r.enclosed),
                             fmt::format("{:.1f}", valueOf(row, kExtruded)),
                             row[kKind],
                             row[kPrimitives],
                             fmt::format("{:.1f}", valueOf(row, kBytes) * 1e-6),
                             fmt::format("{:.0f}", valueOf(row, kPeak) * 1e-6),
                             fmt::format("{:.2f}", valueOf(row, kRead)),
                             fmt::format("{:.2f}", valueOf(row, kConvert)),
                             fmt::format("{:.2f}", valueOf(row, kBuild)),
                             fmt::format("{:.2f}", sample(row) * kComparedSamples),
                             fmt::format("{:.2f}", total(row, kComparedSamples)),
                             fmt::format("{:.2f}", total(row, kComparedSamples, true)),
                             orNothing(total(row, 1), "{:.2f}"),
                             orNothing(total(row, 1, true), "{:.2f}"),
                             fmt::format("{:.2f}", valueOf(row, kRays) / valueOf(row, kRender) * 1e-6),
                             orNothing(valueOf(row, kNoise), "{:.2e}"),
                             orNothing(valueOf(row, kBias), "{:.2e}"),
                             orNothing(valueOf(row, kSeries), "{:.2f}"),
                             row.back()});
    }
    page.table({"print",
                "class",
                "cm\u00b3 enclosed",
                "cm\u00b3 extruded",
                "as",
                "primitives",
                "MB",
                "peak MB",
                "parse s",
                "convert s",
                "build s",
                "render s",
                "total s",
                "total wall s",
                "first look s",
                "first look wall s",
                "Mrays/CPU s",
                "noise",
                "bias",
                "series s",
                "run"},
               cells, {}, lines, "polygons_prints");
}

// A level set and a peer, each the fastest of its side.
struct Match {
    const Row& own;
    const Row& peer;
    double advantage(int spp) const { return total(peer, spp) - total(own, spp); }
    std::string ratio(int spp, bool wall) const {
        return orNothing(total(peer, spp, wall) / total(own, spp, wall), "{:.2f}");
    }
};

// From or up to which number of samples the level set is ahead: of the totals that were measured between them, beyond
// them by what a sample more takes.
std::string whereAhead(const Match& m) {
    const double first = m.advantage(1);
    const double last = m.advantage(kComparedSamples);
    if (!std::isfinite(first)) return "-";
    const double slope = sample(m.peer) - sample(m.own);
    const auto upTo = [](double spp) { return fmt::format("up to {:.0f} spp", std::floor(spp)); };
    const auto from = [](double spp) { return fmt::format("from {:.0f} spp", std::ceil(spp)); };
    if ((first > 0) != (last > 0)) {
        const double crossing = 1 + (kComparedSamples - 1) * first / (first - last);
        return first > 0 ? upTo(crossing) : from(crossing);
    }
    if ((last > 0) == (slope > 0)) return last > 0 ? "always" : "never";
    const double crossing = kComparedSamples - last / slope;
    return last > 0 ? upTo(crossing) : from(crossing);
}

constexpr double kCounts = 100;   // cm3: prints that the aims are for
constexpr double kNearly = 0.99;  // of it counts: models are scaled to a volume, and slicing loses a little of it
constexpr double kAim = 1.5;      // times faster

void addVerdict(Page& page, const PrintIntegrator& integrator, const std::vector<PrintResult>& results,
                StudyReport& report) {
    std::vector<Row> finished;
    std::vector<Row> looks;
    int large = 0;
    int reached = 0;
    int looked = 0;
    int not_slower = 0;
    for (const PrintResult& r : results) {
        const Row* own = r.best(true, kComparedSamples);
        const Row* peer = r.best(false, kComparedSamples);
        if (own == nullptr || peer == nullptr) continue;
        const bool counts = r.enclosed >= kNearly * kCounts;
        const Match m{*own, *peer};
        const bool exact = exactEnough(*own, kComparedSamples);
        const bool ok = total(*peer, kComparedSamples) >= kAim * total(*own, kComparedSamples) && exact;
        large += counts ? 1 : 0;
        reached += counts && ok ? 1 : 0;
        finished.push_back({r.name, fmt::format("{:.1f}", r.enclosed), fmt::format("{:.2f}", valueOf(*own, kRead)),
                            (*own)[kKind], (*peer)[kKind], fmt::format("{:.2f}", total(*own, kComparedSamples)),
                            fmt::format("{:.2f}", total(*peer, kComparedSamples)), m.ratio(kComparedSamples, false),
                            m.ratio(kComparedSamples, true), fmt::format("{:.2f}", sample(*peer) / sample(*own)),
                            whereAhead(m), exact ? "yes" : "no", counts ? (ok ? "reached" : "not reached") : "-"});
        const Row* own_look = r.best(true, 1);
        const Row* peer_look = r.best(false, 1);
        if (own_look == nullptr || peer_look == nullptr) continue;
        const Match look{*own_look, *peer_look};
        const bool fast = look.advantage(1) >= 0;
        looked += counts ? 1 : 0;
        not_slower += counts && fast ? 1 : 0;
        looks.push_back({r.name, fmt::format("{:.1f}", r.enclosed), (*own_look)[kKind], (*peer_look)[kKind],
                         fmt::format("{:.2f}", total(*own_look, 1)), fmt::format("{:.2f}", total(*peer_look, 1)),
                         look.ratio(1, false), look.ratio(1, true), counts ? (fast ? "not slower" : "slower") : "-"});
    }
    if (finished.empty()) return;
    page.heading(fmt::format("Level set against the best peer, {}", integrator.what));
    page.paragraph(fmt::format(
        "The fastest level set and the fastest peer, of those whose bias is below the noise of the picture (the "
        "fastest of all if none is): total CPU time (convert, build, render at {} spp; parsing is told apart), the "
        "peer's by the level set's; the same of wall time, and of a sample alone; where, by number of samples, this "
        "level set is ahead of this peer in CPU time. The aim, for {:g} cm\u00b3 and more: {:g} times faster, bias "
        "below the noise.",
        kComparedSamples, kCounts, kAim));
    page.table({"print", "cm\u00b3", "parse s", "level set", "best peer", "level set s", "peer s", "total, times",
                "total wall, times", "a sample, times", "level set is ahead", "bias below noise", "aim"},
               finished, "not reached");
    const auto tell = [&](const std::string& verdict) {
        if (large == 0) return;
        report.findings.push_back(verdict);
        page.paragraph("Verdict. " + verdict + ".");
    };
    tell(fmt::format(
        "{}, {} spp: level set at least {:g} times faster than the best peer, bias below noise: {} of {} prints of "
        "{:g} cm\u00b3 and more",
        integrator.what, kComparedSamples, kAim, reached, large, kCounts));
    if (looks.empty()) return;
    page.paragraph(
        "The same of a first look, one sample a pixel and everything before it, in processes that had made nothing "
        "yet. Its noise hides more, so coarser ways are allowed on both sides. The aim: not slower.");
    page.table({"print", "cm\u00b3", "level set", "best peer", "level set s", "peer s", "total, times",
                "total wall, times", "aim"},
               looks, "slower");
    tell(fmt::format("{}, 1 spp: level set not slower than the best peer: {} of {} prints of {:g} cm\u00b3 and more",
                     integrator.what, not_slower, looked, kCounts));
}

void addPlots(Page& page, const std::string& how, const std::vector<PrintResult>& results,
              const std::vector<std::string>& kinds) {
    Plot times{"Total time at 32 spp, " + how, "cm\u00b3 enclosed", "CPU seconds", true, true, {}};
    Plot looks{"A first look: 1 spp from nothing, " + how, "cm\u00b3 enclosed", "CPU seconds", true, true, {}};
    Plot ready{"Ready for rays (convert and build)", "cm\u00b3 enclosed", "CPU seconds", true, true, {}};
    Plot memory{"Memory that rays need", "cm\u00b3 enclosed", "MB", true, true, {}};
    for (const std::string& kind : kinds) {
        Series t{kind, {}, false, false};
        Series b = t;
        Series m = t;
        Series l = t;
        for (const PrintResult& r : results) {
            const Row* row = r.find(kind);
            if (row == nullptr) continue;
            t.points.emplace_back(r.enclosed, total(*row, kComparedSamples));
            if (std::isfinite(total(*row, 1))) l.points.emplace_back(r.enclosed, total(*row, 1));
            b.points.emplace_back(r.enclosed, valueOf(*row, kConvert) + valueOf(*row, kBuild));
            m.points.emplace_back(r.enclosed, valueOf(*row, kBytes) * 1e-6);
        }
        if (t.points.empty()) continue;
        times.series.push_back(std::move(t));
        ready.series.push_back(std::move(b));
        memory.series.push_back(std::move(m));
        if (!l.points.empty()) looks.series.push_back(std::move(l));
    }
    page.plot(times);
    if (!looks.series.empty()) page.plot(looks);
    page.plot(ready);
    page.plot(memory);
}

void addSplits(Page& page, const std::string& how, const std::vector<PrintResult>& results) {
    for (const PrintResult& r : results) {
        if (r.sweep.empty()) continue;
        Plot plot{fmt::format("Segments cut at a largest length : width, {}, {}", r.name, how),
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
                ready.points.emplace_back(x, valueOf(row, kBuild));
                render.points.emplace_back(x, valueOf(row, kRender));
            }
            plot.series.push_back(std::move(ready));
            plot.series.push_back(std::move(render));
        }
        page.plot(plot);
    }
}

}  // namespace

double valueOf(const Row& row, PrintColumn column) {
    return row[column].empty() ? std::numeric_limits<double>::quiet_NaN() : numberIn(row, column);
}

const char* sizeClassOf(double cm3) { return cm3 < 30 ? "small" : cm3 < 300 ? "middle" : "large"; }

const Row* PrintResult::find(const std::string& kind) const {
    for (const Row& row : rows)
        if (row[kKind] == kind) return &row;
    return nullptr;
}

const Row* PrintResult::best(bool level_sets, int spp) const {
    const Row* least = nullptr;
    const auto rank = [spp](const Row& row) { return std::pair(!exactEnough(row, spp), total(row, spp)); };
    for (const Row& row : rows) {
        if (row[kKind].starts_with(kLevelSet) != level_sets || !std::isfinite(total(row, spp))) continue;
        if (least == nullptr || rank(row) < rank(*least)) least = &row;
    }
    return least;
}

void addPrints(Page& page, const PrintIntegrator& integrator, const std::vector<PrintResult>& results,
               const std::vector<std::string>& kinds, StudyReport& report) {
    addPlots(page, integrator.what, results, kinds);
    addVerdict(page, integrator, results, report);
    addSplits(page, integrator.what, results);
    page.heading(fmt::format("Everything measured of prints, {}", integrator.what));
    addEverything(page, results);
}

}  // namespace stratum::study
