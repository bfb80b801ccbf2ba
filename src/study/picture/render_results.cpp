#include "study/picture/render_results.h"

#include "study/picture/flip.h"
#include "study/picture/image_error.h"
#include "study/report/power_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace stratum::study {
namespace {

constexpr std::size_t kVariant = 4, kSpp = 5, kWall = 7, kCpu = 8, kError = 10, kFlip = 11, kFineError = 12;

// A single number of samples has none.
std::string exponentText(const PowerLaw& law) {
    return std::isfinite(law.exponent) ? fmt::format("{:.2f}", law.exponent) : "-";
}

}  // namespace

const Row kRenderColumns{"print",   "sha256", "size",         "reference_spp", "variant",
                         "spp",     "seed",   "wall_seconds", "cpu_seconds",   "rays",
                         "rel_mse", "flip",   "rel_mse_fine", "flip_fine"};

RenderResults::RenderResults(const std::vector<Row>& rows, const ResultTable& table) {
    std::map<std::pair<std::string, int>, std::vector<const Row*>> groups;
    for (const Row& row : rows) groups[{row[kVariant], std::atoi(row[kSpp].c_str())}].push_back(&row);
    for (const auto& [key, group] : groups) {
        RenderPoint p;
        p.spp = key.second;
        p.line = table.lineOf(*group.front());
        p.run = group.front()->back();
        const auto column = [&rows_of = group](std::size_t c) {
            std::vector<double> values;
            values.reserve(rows_of.size());
            for (const Row* row : rows_of) values.push_back(numberIn(*row, c));
            return values;
        };
        const auto median = [](std::vector<double> values) {
            std::sort(values.begin(), values.end());
            return values[values.size() / 2];
        };
        const auto mean = [](const std::vector<double>& values, double& deviation) {
            double sum = 0;
            for (const double v : values) sum += v / static_cast<double>(values.size());
            double squares = 0;
            for (const double v : values) squares += (v - sum) * (v - sum);
            deviation = values.size() > 1 ? std::sqrt(squares / (static_cast<double>(values.size()) - 1)) : 0;
            return sum;
        };
        double unused = 0;
        p.wall = median(column(kWall));
        p.cpu = median(column(kCpu));
        p.error = mean(column(kError), p.spread);
        p.flip = mean(column(kFlip), p.flip_spread);
        p.fine = mean(column(kFineError), unused);
        points_[key.first].push_back(p);  // the keys ascend
    }
}

Series RenderResults::series(const std::string& variant, double RenderPoint::*x, double RenderPoint::*y,
                             const std::string& name, bool dashed, int color) const {
    Series s{name.empty() ? variant : name, {}, dashed, true, color};
    for (const RenderPoint& p : of(variant)) {
        s.points.emplace_back(p.*x, p.*y);
        const double spread = y == &RenderPoint::error ? p.spread : y == &RenderPoint::flip ? p.flip_spread : 0;
        if (spread > 0) s.bars.emplace_back(p.*y - spread, p.*y + spread);
    }
    if (s.bars.size() != s.points.size()) s.bars.clear();
    return s;
}

double flipOf(const shade::Film& reference, const shade::Film& picture) {
    shade::Film same(reference.frameWidth(), reference.frameHeight(), reference.region(), picture.content());
    same.pixels() = reference.pixels();
    return meanFlip(displayed(same), displayed(picture));
}

void addComparison(Page& page, const RenderResults& results, const char* title,
                   const std::vector<std::string>& variants) {
    page.heading(title);
    const auto plot = [&](const char* what, const char* x_label, const char* y_label, double RenderPoint::*x,
                          double RenderPoint::*y) {
        Plot p{fmt::format("{}: {}", title, what), x_label, y_label, true, true, {}};
        for (const std::string& variant : variants) p.series.push_back(results.series(variant, x, y));
        page.plot(p);
    };
    plot("error against CPU time", "CPU seconds", "relMSE", &RenderPoint::cpu, &RenderPoint::error);
    plot("error against wall time", "wall seconds", "relMSE", &RenderPoint::wall, &RenderPoint::error);
    plot("what is seen", "CPU seconds", "mean FLIP", &RenderPoint::cpu, &RenderPoint::flip);
}

void addSlopes(Page& page, const RenderResults& results, const std::vector<Variant>& variants) {
    std::vector<Row> cells;
    const std::vector<RenderPoint>& base = results.of(variants.front().name);
    const double aim = base.back().error;  // of the plain one at its best
    for (const Variant& v : variants) {
        const std::vector<RenderPoint>& points = results.of(v.name);
        const auto law = [&](double RenderPoint::*x, double RenderPoint::*y) {
            std::vector<std::pair<double, double>> pairs;
            pairs.reserve(points.size());
            for (const RenderPoint& p : points) pairs.emplace_back(p.*x, p.*y);
            return fitPowerLaw(pairs);
        };
        const PowerLaw by_cpu = law(&RenderPoint::cpu, &RenderPoint::error);
        const double ratio = points.front().cpu / points.front().spp / (base.back().cpu / base.back().spp);
        const RenderPoint& last = points.back();
        // Where its line reaches the plain one's best error; nothing where it does not fall.
        const double seconds = std::pow(aim / by_cpu.factor, 1 / by_cpu.exponent);
        const bool reaches = by_cpu.exponent < -0.3 && v.reference == variants.front().reference;
        cells.push_back(
            {v.name, v.reference, std::to_string(last.spp), fmt::format("{:.3f}", last.wall),
             fmt::format("{:.3f}", last.cpu), fmt::format("{:.2f}", ratio), fmt::format("{:.3e}", last.error),
             fmt::format("{:.1f}", last.error > 0 ? last.spread / last.error * 100 : 0),
             fmt::format("{:.4f}", last.flip), exponentText(by_cpu),
             exponentText(law(&RenderPoint::cpu, &RenderPoint::flip)), reaches ? fmt::format("{:.2f}", seconds) : "-"});
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

void addEverything(Page& page, const RenderResults& results, const std::vector<Variant>& variants) {
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const Variant& v : variants)
        for (const RenderPoint& p : results.of(v.name)) {
            lines.push_back(p.line);
            const auto percent = [](double deviation, double mean) {
                return fmt::format("{:.1f}", mean > 0 ? deviation / mean * 100 : 0);
            };
            cells.push_back({v.name, std::to_string(p.spp), fmt::format("{:.4f}", p.wall), fmt::format("{:.4f}", p.cpu),
                             fmt::format("{:.3e}", p.error), percent(p.spread, p.error), fmt::format("{:.4f}", p.flip),
                             percent(p.flip_spread, p.flip), p.run});
        }
    page.heading("Everything measured");
    page.paragraph("Medians of the times; means of the errors, with their standard deviation from seed to seed.");
    page.table({"variant", "spp", "wall s", "CPU s", "relMSE", "\u00b1 %", "FLIP", "\u00b1 %", "run"}, cells, {}, lines,
               "render");
}

void addVoxels(Page& page, const RenderResults& results, const RenderPlan& plan, References& references) {
    const auto referenceOf = [&](int per_layer) -> const shade::Film& {
        return references.of(plan.referenceNamed(ofSize(per_layer)));
    };
    const auto nameOf = [&](int n) {
        return n == plan.base ? std::string("brick") : fmt::format("brick, {} a layer", n);
    };
    page.heading("Voxel sizes: geometry and noise apart");
    page.paragraph(fmt::format(
        "Against its own reference (same voxels) a picture's error is noise alone. Against the reference of {} voxels "
        "a layer it is noise and geometry. How far the references are from each other is geometry alone: the line on "
        "which the second kind flattens out.",
        plan.per_layer.back()));
    Plot plot{"Noise (full) and all of the error (dashed)", "CPU seconds", "relMSE", true, true, {}};
    std::vector<Row> cells;
    int color = 0;
    for (const int n : plan.per_layer) {
        plot.series.push_back(results.series(nameOf(n), &RenderPoint::cpu, &RenderPoint::error,
                                             fmt::format("{} a layer, noise", n), false, color));
        if (n != plan.per_layer.back()) {
            plot.series.push_back(results.series(nameOf(n), &RenderPoint::cpu, &RenderPoint::fine,
                                                 fmt::format("{} a layer, all", n), true, color));
            const shade::Film& coarse = referenceOf(n);
            const shade::Film& fine = referenceOf(plan.per_layer.back());
            const double bias = relativeSquaredError(coarse, fine);
            const std::vector<RenderPoint>& points = results.of(nameOf(n));
            // Noise falls with the order that was measured, from its last point on.
            std::vector<std::pair<double, double>> pairs;
            pairs.reserve(points.size());
            for (const RenderPoint& p : points) pairs.emplace_back(p.spp, p.error);
            const PowerLaw noise = fitPowerLaw(pairs);
            cells.push_back({std::to_string(n), fmt::format("{:.3e}", bias),
                             fmt::format("{:.4f}", flipOf(fine, coarse)), fmt::format("{:.3e}", points.back().error),
                             std::to_string(points.back().spp),
                             fmt::format("{:.0f}", std::pow(bias / noise.factor, 1 / noise.exponent))});
        }
        ++color;
    }
    page.plot(plot);
    page.table({"voxels a layer", "relMSE of the geometry", "FLIP of the geometry", "relMSE of the noise", "at spp",
                "spp at which both are equal"},
               cells);
}

}  // namespace stratum::study
