// Roughness: Ra and Rz of stacked walls, beside what the section's shape foretells and what others measured.
#include "deposit/printer.h"
#include "report/walls/roughness.h"
#include "study/deposit/deposit_parts.h"
#include "study/deposit/made_programs.h"
#include "study/deposit/published.h"
#include "study/geometry/handmade.h"
#include "study/geometry/surface_error.h"
#include "study/print.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/grid/exterior.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace stratum::study {
namespace {

constexpr const char* kRoughnessColumns =
    "layer_mm,section_percent,flow_percent,per_layer,lines,ra_um,ra_low_um,ra_high_um,rz_um,shape_ra_um,"
    "off_percent";
struct Wall {
    double layer;    // mm
    int section;     // %, of half the layer: the corners' radius
    int flow = 100;  // %
};

constexpr double kWallWidth = 0.45;  // mm, as a stadium and at a flow of 100 %

std::vector<Wall> wallsToMeasure(bool quick) {
    std::vector<Wall> walls;
    const std::vector<double> layers = quick ? std::vector<double>{0.1, 0.2} : std::vector<double>{0.1, 0.15, 0.2, 0.3};
    const std::vector<int> sections = quick ? std::vector<int>{100, 50} : std::vector<int>{100, 75, 50, 25};
    for (const double layer : layers)
        for (const int section : sections) walls.push_back({layer, section});
    for (const int section : sections)
        for (const int flow : {105, 110})
            if (!quick || flow == 110) walls.push_back({0.2, section, flow});
    return walls;
}

Row roughnessOf(const Wall& wall, int per_layer) {
    openvdb::initialize();
    gcode::ReadOptions read;
    deposit::parseSection(fmt::format("{}%", wall.section), read.deposit);
    constexpr double kHeight = 4.5;  // mm: five sampling lengths of layers up to 0.3 mm, and a layer
    const auto layers = static_cast<int>(std::ceil(kHeight / wall.layer));
    const gcode::Toolpath toolpath =
        deposit::readPrint(wallProgram(wall.layer, kWallWidth, 0.01 * wall.flow, layers), "wall", read, false).toolpath;
    const std::vector<std::uint32_t> beads = allBeads(toolpath);
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, per_layer);
    const auto grid = voxelize::voxelize(toolpath, beads, lattice);
    const report::LeafMap map(*grid);
    const report::Outside outside(map, report::hullClearance(lattice), lattice.voxel_size,
                                  static_cast<double>(grid->background()));
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, beads);
    std::vector<double> ra;
    double rz = 0;
    for (const report::RoughnessLine& line :
         report::measureRoughness(*grid, toolpath, stack, beads, lattice, map, &outside)) {
        ra.push_back(line.ra * 1e3);
        rz += line.rz * 1e3;
    }
    if (ra.empty()) throw std::runtime_error("no line of the wall is long enough");
    const auto count = static_cast<double>(ra.size());
    const double mean = std::accumulate(ra.begin(), ra.end(), 0.0) / count;
    const auto [low, high] = std::minmax_element(ra.begin(), ra.end());
    const double shape = 1e3 * wallRoughness(wall.layer, 0.5 * wall.layer * 0.01 * wall.section);
    return figures({wall.layer, static_cast<double>(wall.section), static_cast<double>(wall.flow),
                    static_cast<double>(per_layer), count, mean, *low, *high, rz / count, shape,
                    (mean / shape - 1) * 100});
}

double publishedMean(const PublishedRoughness& published) {
    return std::accumulate(published.ra_um.begin(), published.ra_um.end(), 0.0) /
           static_cast<double>(published.ra_um.size());
}

void plotRoughness(Page& page, const Table& table) {
    Plot plot{"Ra of walls", "layer height, mm", "Ra, \u00b5m", false, false, {}};
    for (const char* section : {"100", "75", "50", "25"}) {
        Series series{fmt::format("corners of {} % of h / 2", section), {}};
        for (const Row& row : table.rows()) {
            if (table.text(row, "section_percent") != section || table.text(row, "flow_percent") != "100") continue;
            series.points.emplace_back(table.number(row, "layer_mm"), table.number(row, "ra_um"));
            series.bars.emplace_back(table.number(row, "ra_low_um"), table.number(row, "ra_high_um"));
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    Series published{"published, PLA", {}, true};
    for (const PublishedRoughness& p : kPublishedRoughness) {
        published.points.emplace_back(p.layer_mm, publishedMean(p));
        published.bars.emplace_back(*std::min_element(p.ra_um.begin(), p.ra_um.end()),
                                    *std::max_element(p.ra_um.begin(), p.ra_um.end()));
    }
    plot.series.push_back(std::move(published));
    page.plot(plot);
}

// Where a printer's walls are as rough as published, by the shape alone.
void addPublished(Page& page) {
    std::vector<Row> cells;
    for (const PublishedRoughness& p : kPublishedRoughness) {
        const double stadium = 1e3 * wallRoughness(p.layer_mm, 0.5 * p.layer_mm);
        const double mean = publishedMean(p);
        cells.push_back({fmt::format("{:g}", p.layer_mm),
                         fmt::format("{:.2f} .. {:.2f}", *std::min_element(p.ra_um.begin(), p.ra_um.end()),
                                     *std::max_element(p.ra_um.begin(), p.ra_um.end())),
                         fmt::format("{:.2f}", mean), fmt::format("{:.2f}", stadium),
                         fmt::format("{:+.0f}", (stadium / mean - 1) * 100)});
    }
    page.paragraph(fmt::format(
        "Published: {}; three runs a layer height. A stadium is the roughest section that the model has; where "
        "measured walls are rougher (thin layers), something else than the shape of the beads makes them so, and the "
        "model has no part of it.",
        kRoughnessSource));
    page.table({"layer mm", "published Ra \u00b5m", "mean", "a stadium's", "off %"}, cells);
    const double change = (kPublishedFlow[1].ra_um / kPublishedFlow[0].ra_um - 1) * 100;
    page.paragraph(fmt::format(
        "With the flow from 100 to 110 % Ra of a printed surface changed by {:+.0f} % ({} \u00b1 {} to {} \u00b1 {} "
        "\u00b5m; {}; the layer height is not in its caption). A lone wall of this model does not change: more flow "
        "makes it wider, with the same corners. Only a smaller radius (--section) would follow the measurement.",
        change, kPublishedFlow[0].ra_um, kPublishedFlow[0].spread_um, kPublishedFlow[1].ra_um,
        kPublishedFlow[1].spread_um, kFlowSource));
}

}  // namespace

double wallRoughness(double height, double radius) {
    constexpr int kSteps = 20000;
    const double side = 0.5 * height - radius;  // half of what is straight
    std::vector<double> depth(kSteps);
    double mean = 0;
    for (int n = 0; n < kSteps; ++n) {
        const double z = (n + 0.5) / kSteps * 0.5 * height;
        const double over = std::max(z - side, 0.0);
        depth[static_cast<std::size_t>(n)] = radius - std::sqrt(std::max(radius * radius - over * over, 0.0));
        mean += depth[static_cast<std::size_t>(n)] / kSteps;
    }
    double sum = 0;
    for (const double d : depth) sum += std::abs(d - mean) / kSteps;
    return sum;
}

Table studyRoughness(const DepositOptions&, const StudyOptions& common, Page& page, StudyReport&) {
    Table table(kRoughnessColumns);
    const std::vector<Wall> walls = wallsToMeasure(common.quick);
    for (const Wall& wall : walls) {
        // Corners of two voxels; of one in a quick look.
        const int per_layer = std::max(common.quick ? 4 : 8, (common.quick ? 200 : 400) / wall.section);
        table.add(roughnessOf(wall, per_layer));
        common.tell(table.rows().size(), walls.size());
    }
    page.heading("Roughness");
    page.paragraph(fmt::format(
        "Walls of one line a layer, {:g} mm wide, with corners of the section (--section) of 25 to 100 % of half the "
        "layer; 100 % is a stadium. Ra and Rz are what --report measures, along lines up the wall (mean, least and "
        "largest of all lines); \"shape\" is Ra of the exact section by quadrature, \"off\" what the level set "
        "differs from it.",
        kWallWidth));
    plotRoughness(page, table);
    addPublished(page);
    page.table(table);
    return table;
}

}  // namespace stratum::study
