// Corners: how wide a line is where it turns by 90 degrees, against the lag of the flow.
#include "study/deposit/deposit_parts.h"
#include "study/deposit/made_programs.h"
#include "voxelize/beads/bead_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::study {
namespace {

constexpr const char* kCornerColumns =
    "jerk_mm_s,lag_s,advance_s,corner_width_mm,width_ratio,outline_mm,start_width_ratio";

struct CornerCase {
    double jerk;     // mm/s
    double lag;      // s
    double advance;  // s
};

std::vector<CornerCase> cornersToMeasure(bool quick) {
    std::vector<CornerCase> all;
    const std::vector<double> lags =
        quick ? std::vector<double>{0, 0.05} : std::vector<double>{0, 0.01, 0.02, 0.03, 0.04, 0.06, 0.08, 0.1};
    for (const double jerk : {1.0, 8.0}) {
        for (const double lag : lags) all.push_back({jerk, lag, 0});
        for (const double lag : lags)
            if (lag > 0) all.push_back({jerk, lag, lag});
    }
    return all;
}

// The widest and narrowest end (mm) of the pieces that end within a line's width of a place.
std::pair<double, double> widthsNear(const gcode::Toolpath& toolpath, double x, double y) {
    double widest = 0;
    double narrowest = 1e300;
    for (const gcode::Bead& bead : toolpath.beads) {
        const double half_change = 0.5 * gcode::widening(toolpath, bead);
        const std::array<std::pair<double, double>, 2> ends{
            {{std::hypot(bead.x0 - x, bead.y0 - y), static_cast<double>(bead.width) - half_change},
             {std::hypot(bead.x1 - x, bead.y1 - y), static_cast<double>(bead.width) + half_change}}};
        for (const auto& [away, width] : ends)
            if (away <= kCornerWidth) {
                widest = std::max(widest, width);
                narrowest = std::min(narrowest, width);
            }
    }
    return {widest, narrowest};
}

// How far the outline of all beads is from the corner, outwards on its bisector, mm.
double outlineAt(const gcode::Toolpath& toolpath) {
    const double z = 0.5 * kCornerHeight;
    const auto inside = [&](double out) {
        const double x = kCornerAt + out * std::numbers::sqrt2 / 2;
        const double y = kCornerAt - out * std::numbers::sqrt2 / 2;
        return std::any_of(toolpath.beads.begin(), toolpath.beads.end(), [&](const gcode::Bead& bead) {
            return voxelize::BeadField(toolpath, bead).distance(x, y, z) < 0;
        });
    };
    double low = 0;
    double high = 4 * kCornerWidth;
    for (int n = 0; n < 40; ++n) {
        const double middle = 0.5 * (low + high);
        (inside(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

Row cornerOf(const CornerCase& c) {
    gcode::ReadOptions read;
    read.deposit.flow_lag = c.lag;
    read.deposit.pressure_advance = c.advance;
    const gcode::Toolpath toolpath = deposit::readPrint(cornerProgram(c.jerk), "corner", read, false).toolpath;
    const double width = widthsNear(toolpath, kCornerAt, kCornerAt).first;
    const double start = widthsNear(toolpath, kCornerAt - 30, kCornerAt).second;
    return figures({c.jerk, c.lag, c.advance, width, width / kCornerWidth, outlineAt(toolpath) - kCornerWidth / 2,
                    start / kCornerWidth});
}

}  // namespace

Table studyCorner(const DepositOptions&, const StudyOptions& common, Page& page, StudyReport& report) {
    Table table(kCornerColumns);
    const std::vector<CornerCase> all = cornersToMeasure(common.quick);
    Plot plot{
        "Width at a 90-degree corner", "lag of the flow, s", "width at the corner / line's width", false, false, {}};
    for (const double jerk : {1.0, 8.0})
        for (const bool advanced : {false, true})
            plot.series.push_back(
                {fmt::format("jerk {:g} mm/s, {}", jerk, advanced ? "K = T" : "no advance"), {}, advanced});
    for (const CornerCase& c : all) {
        table.add(cornerOf(c));
        const double ratio = table.number(table.rows().back(), "width_ratio");
        for (const bool advanced : {false, true})
            if (c.lag == 0 || (c.advance > 0) == advanced)
                plot.series[(c.jerk > 1 ? 2U : 0U) + (advanced ? 1U : 0U)].points.emplace_back(c.lag, ratio);
        // What the tests promise of an advance that cancels the lag.
        constexpr double kNoBulge = 1e-3;
        if (c.lag == c.advance && std::abs(ratio - 1) > kNoBulge)
            report.findings.push_back(
                fmt::format("a corner with K = T = {:g} s is {} of its line's width", c.lag, ratio));
        common.tell(table.rows().size(), all.size());
    }
    page.heading("Corners");
    page.paragraph(fmt::format(
        "Two lines of 30 mm, {:g} x {:g} mm, that meet at 90 degrees; 60 mm/s, 1000 mm/s\u00b2, classic jerk. The "
        "nozzle slows down at the corner and the flow lags behind it (--flow-lag), so the line is widest there: its "
        "width within one line's width of the corner, over the commanded one. With a pressure advance K as long as the "
        "lag T (--pressure-advance) nothing of it is left. The outline is how far the outside of the corner stands out "
        "on its bisector, the last column the narrowest width at the beginning of the first line. Published are "
        "trends: bulges that grow with the slow-down and thin starts (Comminal et al. 2019, doi "
        "10.1016/j.addma.2019.06.005; Kuipers et al. 2020, arXiv 2004.13497); no figure of theirs is of this corner.",
        kCornerWidth, kCornerHeight));
    page.plot(plot);
    page.table(table);
    return table;
}

}  // namespace stratum::study
