#include "study/study.h"

#include "export/vdb_file.h"
#include "export/vdb_stream.h"
#include "march/brick/brick_intersector.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "study/report/page.h"
#include "study/report/power_law.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxel_choice.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;
using voxelize::Interior;

constexpr const char* kColumns =
    "print,sha256,voxels_per_layer,interior,voxel_mm,active_voxels,leaves,tiles,grid_bytes,float_file_bytes,"
    "half_file_bytes,brick_bytes,estimated_bytes,peak_rss_bytes,voxelize_seconds,write_seconds,brick_seconds,"
    "part_mm3,status";
// How a file comes about: all leaves in a grid, what is seen in one, or block by block without a grid.
constexpr const char* kCull = "cull";
constexpr const char* kStreamed = "keep, no grid";
constexpr std::array<const char*, 3> kWays{"keep", kCull, kStreamed};
constexpr const char* kOk = "ok";
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double availableBytes() {
    return static_cast<double>(::sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double sizeOf(const fs::path& path) {
    const auto bytes = static_cast<double>(fs::file_size(path));
    fs::remove(path);
    return bytes;
}

// What is measured of one print, voxel size and way, in the columns' order.
struct Measured {
    double voxel = kNone, active = kNone, leaves = kNone, tiles = kNone, grid = kNone, float_file = kNone,
           half_file = kNone, bricks = kNone, estimate = kNone, peak = kNone, voxelize_seconds = kNone,
           write_seconds = kNone, brick_seconds = kNone, part = kNone;

    Row cells(const char* status) const {
        return joined(figures({voxel, active, leaves, tiles, grid, float_file, half_file, bricks, estimate, peak,
                               voxelize_seconds, write_seconds, brick_seconds, part}),
                      {status});
    }
};

// As gcode2vdb writes a file when nothing asks for a grid.
void measureStream(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                   const voxelize::Lattice& lattice, const fs::path& scratch, Measured& m) {
    exporter::WrittenGrid written;
    const double seconds = timesOf([&] {
                               voxelize::VoxelizeOptions options;
                               options.bytes_per_leaf = 0;
                               voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
                               const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
                               exporter::describe(*empty, lattice, {});
                               const voxelize::LeafBounds bounds = voxelizer.leafBounds();
                               exporter::VdbStream file(empty, scratch, {}, bounds);
                               voxelizer.stream(0xffffffff, bounds, file, false);
                               m.write_seconds = timesOf([&] { written = file.finish(); }).wall;
                           }).wall;
    m.peak = static_cast<double>(peakSoFar());
    m.voxelize_seconds = seconds - m.write_seconds;
    m.active = static_cast<double>(written.statistics.active_voxels);
    m.leaves = static_cast<double>(written.leaves);
    m.float_file = sizeOf(scratch);
}

void measureGrid(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                 const voxelize::Lattice& lattice, Interior interior, const fs::path& scratch, Measured& m) {
    voxelize::VoxelizeOptions options;
    options.interior = interior;
    openvdb::FloatGrid::Ptr grid;
    m.voxelize_seconds = timesOf([&] { grid = voxelize::voxelize(toolpath, beads, lattice, options); }).wall;
    exporter::FileOptions file;
    m.write_seconds = timesOf([&] { exporter::writeVdb({grid}, scratch, file); }).wall;
    m.float_file = sizeOf(scratch);
    // So far all that converting needs, and nothing else.
    m.peak = static_cast<double>(peakSoFar());
    m.active = static_cast<double>(grid->activeVoxelCount());
    m.leaves = static_cast<double>(grid->tree().leafCount());
    m.tiles = static_cast<double>(grid->tree().activeTileCount());
    m.grid = static_cast<double>(grid->memUsage());
    m.brick_seconds =
        timesOf([&] { m.bricks = static_cast<double>(march::makeBrickIntersector(*grid)->bytes()); }).wall;
    // Last, for it rounds what it writes.
    file.half = true;
    exporter::writeVdb({grid}, scratch, file);
    m.half_file = sizeOf(scratch);
}

// In a process of its own: the cells after the key.
Row measure(const std::string& print, int count, std::string_view way, const fs::path& scratch, double budget) {
    openvdb::initialize();
    const gcode::Toolpath toolpath = readPrint(print);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, count);
    Measured m;
    m.voxel = lattice.voxel_size;
    m.part = voxelize::depositedVolume(toolpath, beads);
    if (way == kStreamed) {
        measureStream(toolpath, beads, lattice, scratch, m);
        return m.cells(kOk);
    }
    const Interior interior = way == kCull ? Interior::cull : Interior::keep;
    m.estimate = voxelize::estimateBytes(toolpath, beads, lattice, interior);
    if (m.estimate > budget) return m.cells("left out: does not fit");
    measureGrid(toolpath, beads, lattice, interior, scratch, m);
    return m.cells(kOk);
}

using Points = std::vector<std::pair<double, double>>;

// Of one print and way, coarse to fine.
struct Curve {
    std::string print, interior;
    std::vector<Row> rows;
};

std::vector<Curve> curvesOf(const Table& table) {
    std::vector<Curve> curves;
    for (const Row& row : table.rows()) {
        if (table.text(row, "status") != kOk) continue;
        const std::string& print = table.text(row, "print");
        const std::string& interior = table.text(row, "interior");
        auto found = std::find_if(curves.begin(), curves.end(),
                                  [&](const Curve& c) { return c.print == print && c.interior == interior; });
        if (found == curves.end()) found = curves.insert(curves.end(), {print, interior, {}});
        found->rows.push_back(row);
    }
    return curves;
}

Points pointsOf(const Table& table, const Curve& curve, const char* column, const char* per = nullptr) {
    Points points;
    for (const Row& row : curve.rows) {
        const double y = table.number(row, column) / (per != nullptr ? table.number(row, per) : 1);
        if (!std::isnan(y)) points.emplace_back(table.number(row, "voxel_mm"), y);
    }
    return points;
}

void addLaws(Page& page, const Table& table, const std::vector<Curve>& curves) {
    std::vector<Row> rows;
    for (const Curve& curve : curves)
        for (const char* column :
             {"grid_bytes", "float_file_bytes", "half_file_bytes", "brick_bytes", "peak_rss_bytes"}) {
            const Points points = pointsOf(table, curve, column);
            if (points.size() < 3) continue;
            const PowerLaw before = fitPowerLaw(std::span(points).first(points.size() - 1));
            const PowerLaw all = fitPowerLaw(points);
            const auto [finest, measured] = points.back();
            const double count = table.number(curve.rows.back(), "voxels_per_layer");
            const double next = finest * count / (count + 1);
            rows.push_back(joined({curve.print, curve.interior, column, fmt::format("{:.2f}", all.exponent)},
                                  {figure(finest), figure(std::round(before.at(finest))), figure(measured),
                                   fmt::format("{:+.1f}", (before.at(finest) / measured - 1) * 100), figure(next),
                                   figure(std::round(all.at(next)))}));
        }
    page.heading("Power laws");
    page.paragraph(
        "bytes = a (voxel size)^exponent, by least squares of the logarithms over all sizes. \"Predicted\" is what the "
        "law says of the finest size when fitted to the coarser ones alone, beside what was then measured. The last "
        "column is the law of all sizes at one voxel a layer more, which nobody has measured here.");
    page.table({"print", "interior", "what", "exponent", "finest mm", "predicted", "measured", "off by %",
                "next size mm", "prediction"},
               rows);
}

void addPlots(Page& page, const Table& table, const std::vector<Curve>& curves) {
    std::set<std::string> drawn;
    Plot each{
        "Memory of the grid for a cubic millimetre of plastic", "voxel size, mm", "bytes per mm\u00b3", true, true, {}};
    Plot time{"Time to voxelize, in a process of its own (fresh memory)", "voxel size, mm", "seconds", true, true, {}};
    for (const Curve& curve : curves) {
        if (!drawn.insert(curve.print).second) continue;
        Plot plot{curve.print, "voxel size, mm", "bytes", true, true, {}};
        const int color = static_cast<int>(drawn.size()) - 1;
        for (const Curve& other : curves) {
            if (other.print != curve.print) continue;
            const bool cull = other.interior == kCull;
            const bool streamed = other.interior == kStreamed;
            const std::array<std::pair<const char*, const char*>, 5> kinds{{{"grid", "grid_bytes"},
                                                                            {"peak RSS", "peak_rss_bytes"},
                                                                            {"bricks", "brick_bytes"},
                                                                            {"file, float", "float_file_bytes"},
                                                                            {"file, half", "half_file_bytes"}}};
            for (std::size_t n = 0; n < kinds.size(); ++n) {
                Points points = pointsOf(table, other, kinds[n].second);
                // Without a grid the file is the same.
                if (points.empty() || (streamed && n != 1)) continue;
                plot.series.push_back({fmt::format("{}, {}", kinds[n].first, other.interior), std::move(points), cull,
                                       true, streamed ? 5 : static_cast<int>(n)});
            }
            if (streamed) continue;
            const std::string name = fmt::format("{}, {}", other.print, other.interior);
            each.series.push_back({name, pointsOf(table, other, "grid_bytes", "part_mm3"), cull, true, color});
            time.series.push_back({name, pointsOf(table, other, "voxelize_seconds"), cull, true, color});
        }
        page.plot(plot);
    }
    page.plot(each);
    page.plot(time);
}

}  // namespace

StudyReport studyMemory(const MemoryOptions& options, const StudyOptions& common) {
    std::vector<int> counts = options.voxels_per_layer;
    if (counts.empty()) counts = common.quick ? std::vector<int>{1, 2, 3} : std::vector<int>{1, 2, 3, 4};
    std::sort(counts.begin(), counts.end());
    Table table(kColumns);
    const fs::path scratch = common.folder / fmt::format(".memory-{}.vdb", ::getpid());
    const std::size_t all = options.prints.size() * counts.size() * kWays.size();
    StudyReport report;
    for (const std::string& print : options.prints)
        for (const int count : counts)
            for (const char* way : kWays) {
                const Row key{fs::path(print).filename().string(), shortHash(print), std::to_string(count), way};
                table.add(joined(key, rowInOwnProcess(fmt::format("{}: {} voxels a layer, {}", print, count, way),
                                                      common.threads, [&] {
                                                          return measure(print, count, way, scratch,
                                                                         options.memory_share * availableBytes());
                                                      })));
                if (const Row& row = table.rows().back(); row.back() != kOk)
                    report.findings.push_back(
                        fmt::format("{} at {} mm, {}: {}", row[0], table.text(row, "voxel_mm"), way, row.back()));
                common.tell(table.rows().size(), all);
            }
    Page page("Memory against voxel size", common.command);
    page.paragraph(
        "Each configuration is a process of its own that reads the print, voxelizes, and writes; its peak is taken "
        "then. keep: all surfaces; cull: what the outside can reach; no grid: leaves go to the file while they are "
        "made, as gcode2vdb does where nothing needs a grid, so that voxelizing and writing are one. Bricks are what "
        "rays are traced through, built after that peak was read. A cubic millimetre of plastic is one that the "
        "nozzle has extruded.");
    const std::vector<Curve> curves = curvesOf(table);
    addPlots(page, table, curves);
    addLaws(page, table, curves);
    page.heading("Everything measured");
    page.table(table);
    writeTable(common, "memory", table, report);
    writePage(common, "memory", page, report);
    return report;
}

}  // namespace stratum::study
