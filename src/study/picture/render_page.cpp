#include "study/picture/render_page.h"

#include "study/cost/times.h"
#include "study/report/power_law.h"

#include <fmt/format.h>

#include <cmath>

namespace stratum::study {
namespace {

double mean(const std::vector<double>& values, double& deviation) {
    double sum = 0;
    for (const double v : values) sum += v / static_cast<double>(values.size());
    double squares = 0;
    for (const double v : values) squares += (v - sum) * (v - sum);
    deviation = values.size() > 1 ? std::sqrt(squares / (static_cast<double>(values.size()) - 1)) : 0;
    return sum;
}

// With bars of a standard deviation where there is one of `y`.
Series seriesOf(const std::vector<RenderPoint>& points, const std::string& name, double RenderPoint::*x,
                double RenderPoint::*y, bool dashed = false, int color = -1) {
    Series s{name, {}, dashed, true, color};
    for (const RenderPoint& p : points) {
        s.points.emplace_back(p.*x, p.*y);
        const double spread = y == &RenderPoint::error ? p.spread : y == &RenderPoint::flip ? p.flip_spread : 0;
        if (spread > 0) s.bars.emplace_back(p.*y - spread, p.*y + spread);
    }
    if (s.bars.size() != s.points.size()) s.bars.clear();
    return s;
}

template <typename X>
PowerLaw lawOf(const std::vector<RenderPoint>& points, X RenderPoint::*x, double RenderPoint::*y) {
    std::vector<std::pair<double, double>> pairs;
    pairs.reserve(points.size());
    for (const RenderPoint& p : points) pairs.emplace_back(p.*x, p.*y);
    return fitPowerLaw(pairs);
}

// A single number of samples has none.
std::string exponentText(const PowerLaw& law) {
    return std::isfinite(law.exponent) ? fmt::format("{:.2f}", law.exponent) : "-";
}

}  // namespace

RenderResults renderResults(const Table& table) {
    std::map<std::pair<std::string, int>, std::vector<const Row*>> groups;
    for (const Row& row : table.rows())
        groups[{table.text(row, "variant"), std::atoi(table.text(row, "spp").c_str())}].push_back(&row);
    RenderResults results;
    for (const auto& [key, rows] : groups) {
        const auto column = [&, &group = rows](const char* name) {
            std::vector<double> values;
            values.reserve(group.size());
            for (const Row* row : group) values.push_back(table.number(*row, name));
            return values;
        };
        RenderPoint p;
        double unused = 0;
        p.spp = key.second;
        p.wall = median(column("wall_seconds"));
        p.cpu = median(column("cpu_seconds"));
        p.error = mean(column("rel_mse"), p.spread);
        p.flip = mean(column("flip"), p.flip_spread);
        p.fine = mean(column("rel_mse_fine"), unused);
        results[key.first].push_back(p);  // the keys ascend
    }
    return results;
}

void addComparison(Page& page, const RenderResults& results, const char* title,
                   const std::vector<std::string>& variants) {
    page.heading(title);
    const auto plot = [&](const char* what, const char* x_label, const char* y_label, double RenderPoint::*x,
                          double RenderPoint::*y) {
        Plot p{fmt::format("{}: {}", title, what), x_label, y_label, true, true, {}};
        for (const std::string& variant : variants) p.series.push_back(seriesOf(results.at(variant), variant, x, y));
        page.plot(p);
    };
    plot("error against CPU time", "CPU seconds", "relMSE", &RenderPoint::cpu, &RenderPoint::error);
    plot("error against wall time", "wall seconds", "relMSE", &RenderPoint::wall, &RenderPoint::error);
    plot("what is seen", "CPU seconds", "mean FLIP", &RenderPoint::cpu, &RenderPoint::flip);
}

void addSlopes(Page& page, const RenderResults& results,
               const std::vector<std::pair<std::string, std::string>>& variants) {
    std::vector<Row> cells;
    const RenderPoint& base = results.at(variants.front().first).back();  // the plain one at its best
    for (const auto& [name, reference] : variants) {
        const std::vector<RenderPoint>& points = results.at(name);
        const RenderPoint& last = points.back();
        const PowerLaw by_cpu = lawOf(points, &RenderPoint::cpu, &RenderPoint::error);
        const double ratio = points.front().cpu / points.front().spp / (base.cpu / base.spp);
        // Where its line reaches the plain one's best error; nothing where it does not fall.
        const double seconds = std::pow(base.error / by_cpu.factor, 1 / by_cpu.exponent);
        const bool reaches = by_cpu.exponent < -0.3 && reference == variants.front().second;
        cells.push_back({name, reference, std::to_string(last.spp), fmt::format("{:.3f}", last.wall),
                         fmt::format("{:.3f}", last.cpu), fmt::format("{:.2f}", ratio),
                         fmt::format("{:.3e}", last.error),
                         fmt::format("{:.1f}", last.error > 0 ? last.spread / last.error * 100 : 0),
                         fmt::format("{:.4f}", last.flip), exponentText(by_cpu),
                         exponentText(lawOf(points, &RenderPoint::cpu, &RenderPoint::flip)),
                         reaches ? fmt::format("{:.2f}", seconds) : "-"});
    }
    page.heading("Slopes");
    page.paragraph(
        "At the most samples of each: medians of the times and means of the errors over the seeds, and the standard "
        "deviation of the error from seed to seed. Orders are exponents of the CPU time, least squares of logarithms "
        "over all numbers of samples: -1 is what independent samples give relMSE, -0.5 what they give FLIP where it is "
        "proportional to the error; a number nearer to 0 means that something else than noise is left: bias, or the "
        "reference's own. The last column is the CPU time at which a variant's line meets the best error of the "
        "first, where both have one reference and the line falls.");
    page.table({"variant", "reference", "spp", "wall s", "CPU s", "CPU a sample", "relMSE", "\u00b1 %", "FLIP",
                "order of relMSE", "order of FLIP", "CPU s to the same error"},
               cells);
}

void addVoxels(Page& page, const RenderResults& results, const std::vector<VoxelBias>& sizes) {
    page.heading("Voxel sizes: geometry and noise apart");
    page.paragraph(fmt::format(
        "Against its own reference (same voxels) a picture's error is noise alone. Against the reference of {} voxels "
        "a layer it is noise and geometry. How far the references are from each other is geometry alone: the line on "
        "which the second kind flattens out.",
        sizes.back().per_layer));
    Plot plot{"Noise (full) and all of the error (dashed)", "CPU seconds", "relMSE", true, true, {}};
    std::vector<Row> cells;
    for (std::size_t n = 0; n < sizes.size(); ++n) {
        const VoxelBias& size = sizes[n];
        const std::vector<RenderPoint>& points = results.at(size.variant);
        plot.series.push_back(seriesOf(points, fmt::format("{} a layer, noise", size.per_layer), &RenderPoint::cpu,
                                       &RenderPoint::error, false, static_cast<int>(n)));
        if (n + 1 == sizes.size()) break;
        plot.series.push_back(seriesOf(points, fmt::format("{} a layer, all", size.per_layer), &RenderPoint::cpu,
                                       &RenderPoint::fine, true, static_cast<int>(n)));
        // Noise falls with the order that was measured, from its last point on.
        const PowerLaw noise = lawOf(points, &RenderPoint::spp, &RenderPoint::error);
        cells.push_back({std::to_string(size.per_layer), fmt::format("{:.3e}", size.error),
                         fmt::format("{:.4f}", size.flip), fmt::format("{:.3e}", points.back().error),
                         std::to_string(points.back().spp),
                         fmt::format("{:.0f}", std::pow(size.error / noise.factor, 1 / noise.exponent))});
    }
    page.plot(plot);
    page.table({"voxels a layer", "relMSE of the geometry", "FLIP of the geometry", "relMSE of the noise", "at spp",
                "spp at which both are equal"},
               cells);
}

}  // namespace stratum::study
