#include "study/polygons/print_page.h"

#include "study/polygons/print_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace stratum::study {

const char* const kPrintColumns =
    "print,sha256,integrator,light,size,spp,threads,representation,extruded_cm3,enclosed_cm3,primitives,bytes,"
    "peak_rss_bytes,read_cpu,convert_cpu,build_cpu,render_cpu,first_look_cpu,convert_wall,build_wall,render_wall,"
    "first_look_wall,rays,noise,bias";

namespace {

constexpr double kLarge = 99;  // cm3: models are scaled to 100, and slicing loses a little of it

// What it takes until a picture is there: of the thesis's number of samples, in proportion to those that were rendered,
// or of one, as a first look measured it. NaN where none did.
double total(const Table& t, const Row& row, int spp, bool wall = false) {
    if (spp == 1) return t.number(row, wall ? "first_look_wall" : "first_look_cpu");
    return t.number(row, wall ? "convert_wall" : "convert_cpu") + t.number(row, wall ? "build_wall" : "build_cpu") +
           t.number(row, wall ? "render_wall" : "render_cpu") * spp / t.number(row, "spp");
}

double sample(const Table& t, const Row& row) { return t.number(row, "render_cpu") / t.number(row, "spp"); }

// The noise was measured with kComparedSamples; of fewer it is larger, at least in proportion.
bool exactEnough(const Table& t, const Row& row, int spp) {
    return t.number(row, "bias") < t.number(row, "noise") * kComparedSamples / spp;
}

// All rows of one print.
struct PrintResult {
    std::string name;
    std::vector<Row> rows;  // one a representation
    double enclosed = 0;    // cm3
};

// A level set and a peer, each the fastest of its side.
struct Match {
    const Table& t;
    const Row& own;
    const Row& peer;
    double advantage(int spp) const { return total(t, peer, spp) - total(t, own, spp); }
    std::string ratio(int spp, bool wall) const {
        const double times = total(t, peer, spp, wall) / total(t, own, spp, wall);
        return std::isfinite(times) ? fmt::format("{:.2f}", times) : "-";
    }
    Row cells(const PrintResult& r, int spp) const {
        return {r.name,
                fmt::format("{:.1f}", r.enclosed),
                t.text(own, "representation"),
                t.text(peer, "representation"),
                fmt::format("{:.2f}", total(t, own, spp)),
                fmt::format("{:.2f}", total(t, peer, spp)),
                ratio(spp, false),
                ratio(spp, true)};
    }
};

// From or up to which number of samples the level set is ahead: of the totals that were measured between them, beyond
// them by what a sample more takes.
std::string whereAhead(const Match& m) {
    const double first = m.advantage(1);
    const double last = m.advantage(kComparedSamples);
    if (!std::isfinite(first)) return "-";
    const double slope = sample(m.t, m.peer) - sample(m.t, m.own);
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

// The best of both sides, print by print; then how many large prints are ahead, and by how much on the median.
void addMatches(Page& page, const Table& t, const std::string& what, const std::vector<PrintResult>& results, int spp,
                StudyReport& report) {
    std::vector<Row> rows;
    std::vector<double> ratios;
    for (const PrintResult& r : results) {
        const Row* own = bestOf(t, r.rows, true, spp);
        const Row* peer = bestOf(t, r.rows, false, spp);
        if (own == nullptr || peer == nullptr) continue;
        const Match m{t, *own, *peer};
        rows.push_back(joined(m.cells(r, spp), {fmt::format("{:.2f}", sample(t, *peer) / sample(t, *own)),
                                                whereAhead(m), exactEnough(t, *own, spp) ? "yes" : "no"}));
        if (r.enclosed >= kLarge) ratios.push_back(total(t, *peer, spp) / total(t, *own, spp));
    }
    if (rows.empty()) return;
    page.table({"print", "cm\u00b3", "level set", "best peer", "level set s", "peer s", "total, times",
                "total wall, times", "a sample, times", "level set is ahead", "bias below noise"},
               rows);
    if (ratios.empty()) return;
    const auto ahead = std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio >= 1; });
    report.findings.push_back(
        fmt::format("{}, {} spp: level set not slower than the best peer: {} of {} prints of {:g} cm\u00b3 and more; "
                    "{:.2f} times as fast on the median",
                    what, spp, ahead, ratios.size(), kLarge, median(ratios)));
    page.paragraph(report.findings.back() + ".");
}

void addVerdict(Page& page, const Table& t, const std::string& what, const std::vector<PrintResult>& results,
                StudyReport& report) {
    page.heading(fmt::format("Level set against the best peer, {}", what));
    page.paragraph(fmt::format(
        "The fastest level set and the fastest peer, of those whose bias is below the noise of the picture (the "
        "fastest of all if none is): total CPU time (convert, build, render at {} spp; parsing is in no total), the "
        "peer's by the level set's; the same of wall time, and of a sample alone; where, by number of samples, this "
        "level set is ahead of this peer in CPU time. Then the same of a first look, one sample a pixel and everything "
        "before it, in processes that had made nothing yet: its noise hides more, so coarser ways are allowed.",
        kComparedSamples));
    for (const int spp : {kComparedSamples, 1}) addMatches(page, t, what, results, spp, report);
}

void addPlots(Page& page, const Table& t, const std::string& what, const std::vector<PrintResult>& results) {
    const auto plot = [&](const std::string& title, const char* unit, const auto& valueOf) {
        Plot drawn{title, "cm\u00b3 enclosed", unit, true, true, {}};
        for (const PrintResult& r : results)
            for (const Row& row : r.rows) {
                const std::string& kind = t.text(row, "representation");
                auto series = std::find_if(drawn.series.begin(), drawn.series.end(),
                                           [&](const Series& s) { return s.name == kind; });
                if (series == drawn.series.end())
                    series = drawn.series.insert(drawn.series.end(), {kind, {}, false, false});
                series->points.emplace_back(r.enclosed, valueOf(row));
            }
        page.plot(drawn);
    };
    plot(fmt::format("Total time at {} spp, {}", kComparedSamples, what), "CPU seconds",
         [&](const Row& row) { return total(t, row, kComparedSamples); });
    plot("A first look: 1 spp from nothing, " + what, "CPU seconds", [&](const Row& row) { return total(t, row, 1); });
    plot("Ready for rays (convert and build)", "CPU seconds",
         [&](const Row& row) { return t.number(row, "convert_cpu") + t.number(row, "build_cpu"); });
    plot("Memory that rays need", "MB", [&](const Row& row) { return t.number(row, "bytes") * 1e-6; });
}

}  // namespace

const Row* bestOf(const Table& table, const std::vector<Row>& rows, bool level_sets, int spp) {
    const Row* least = nullptr;
    const auto rank = [&](const Row& row) { return std::pair(!exactEnough(table, row, spp), total(table, row, spp)); };
    for (const Row& row : rows) {
        const bool own = table.text(row, "representation").starts_with("level set");
        if (own != level_sets || !std::isfinite(total(table, row, spp))) continue;
        if (least == nullptr || rank(row) < rank(*least)) least = &row;
    }
    return least;
}

void addPrints(Page& page, const Table& table, const std::string& integrator, const std::string& what,
               StudyReport& report) {
    std::map<std::string, PrintResult> by_name;
    std::vector<Row> all;
    for (const Row& row : table.rows()) {
        if (table.text(row, "integrator") != integrator) continue;
        PrintResult& result = by_name[table.text(row, "print")];
        result.name = table.text(row, "print");
        if (result.rows.empty()) result.enclosed = table.number(row, "enclosed_cm3");
        result.rows.push_back(row);
        all.push_back(row);
    }
    std::vector<PrintResult> results;
    results.reserve(by_name.size());
    for (auto& [name, result] : by_name) results.push_back(std::move(result));
    std::sort(results.begin(), results.end(),
              [](const PrintResult& a, const PrintResult& b) { return a.enclosed < b.enclosed; });
    addPlots(page, table, what, results);
    addVerdict(page, table, what, results, report);
    page.heading(fmt::format("Everything measured of prints, {}", what));
    page.table(table.columns(), all);
}

}  // namespace stratum::study
