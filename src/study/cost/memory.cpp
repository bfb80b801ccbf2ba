#include "study/cost/memory.h"

#include "base/error.h"
#include "export/vdb_file.h"
#include "export/vdb_stream.h"
#include "march/brick/brick_intersector.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "study/report/page.h"
#include "study/report/power_law.h"
#include "study/report/result_table.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxel_choice.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;
using voxelize::Interior;

const Row kColumns{
    "print",           "sha256",         "voxels_per_layer", "interior",         "voxel_mm",        "active_voxels",
    "leaves",          "tiles",          "grid_bytes",       "float_file_bytes", "half_file_bytes", "brick_bytes",
    "estimated_bytes", "peak_rss_bytes", "voxelize_seconds", "write_seconds",    "brick_seconds",   "part_mm3",
    "status"};
constexpr std::size_t kKeys = 4;
enum Column : std::size_t {
    kPrint,
    kHash,
    kCount,
    kInterior,
    kVoxel,
    kActive,
    kLeaves,
    kTiles,
    kGrid,
    kFloatFile,
    kHalfFile,
    kBricks,
    kEstimate,
    kPeak,
    kVoxelizeSeconds,
    kWriteSeconds,
    kBrickSeconds,
    kPart,
    kStatus
};
// How a file comes about: all leaves in a grid, what is seen in one, or block by block without a grid.
constexpr const char* kKeep = "keep";
constexpr const char* kCull = "cull";
constexpr const char* kStreamed = "keep, no grid";
constexpr std::array<const char*, 3> kWays{kKeep, kCull, kStreamed};
constexpr const char* kOk = "ok";
constexpr const char* kLeftOut = "left out: does not fit";

double availableBytes() {
    return static_cast<double>(::sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

std::size_t writtenBytes(const openvdb::FloatGrid::Ptr& grid, const fs::path& path, bool half, double& seconds) {
    exporter::FileOptions options;
    options.half = half;
    seconds = timesOf([&] { exporter::writeVdb({grid}, path, options); }).wall;
    const auto bytes = fs::file_size(path);
    fs::remove(path);
    return bytes;
}

Row leftOut(const voxelize::Lattice& lattice, double estimate, double part) {
    return {fmt::format("{:.9g}", lattice.voxel_size),
            "",
            "",
            "",
            "",
            "",
            "",
            "",
            fmt::format("{:.0f}", estimate),
            "",
            "",
            "",
            "",
            fmt::format("{:.6g}", part),
            kLeftOut};
}

// As gcode2vdb writes a file when nothing asks for a grid.
Row measureStream(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                  const voxelize::Lattice& lattice, const fs::path& scratch, double part) {
    exporter::WrittenGrid written;
    double finish_seconds = 0;
    const double seconds = timesOf([&] {
                               voxelize::VoxelizeOptions options;
                               options.in_memory = false;
                               voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
                               const openvdb::FloatGrid::Ptr empty = voxelizer.emptyGrid();
                               exporter::describe(*empty, lattice, {});
                               const voxelize::LeafBounds bounds = voxelizer.leafBounds();
                               exporter::VdbStream file(empty, scratch, {}, bounds);
                               voxelizer.stream(0xffffffff, bounds, file, false);
                               finish_seconds = timesOf([&] { written = file.finish(); }).wall;
                           }).wall;
    const std::size_t peak = peakSoFar();
    const auto bytes = fs::file_size(scratch);
    fs::remove(scratch);
    return {fmt::format("{:.9g}", lattice.voxel_size),
            std::to_string(written.statistics.active_voxels),
            std::to_string(written.leaves),
            "",
            "",
            std::to_string(bytes),
            "",
            "",
            "",
            std::to_string(peak),
            fmt::format("{:.4f}", seconds - finish_seconds),
            fmt::format("{:.4f}", finish_seconds),
            "",
            fmt::format("{:.6g}", part),
            kOk};
}

Row measureGrid(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                const voxelize::Lattice& lattice, Interior interior, const fs::path& scratch, double estimate,
                double part) {
    voxelize::VoxelizeOptions options;
    options.interior = interior;
    openvdb::FloatGrid::Ptr grid;
    const double voxelize_seconds = timesOf([&] { grid = voxelize::voxelize(toolpath, beads, lattice, options); }).wall;
    double write_seconds = 0;
    double half_seconds = 0;
    const std::size_t float_bytes = writtenBytes(grid, scratch, false, write_seconds);
    // So far all that converting needs, and nothing else.
    const std::size_t peak = peakSoFar();
    const std::size_t active = grid->activeVoxelCount();
    const std::size_t leaves = grid->tree().leafCount();
    const std::size_t tiles = grid->tree().activeTileCount();
    const std::size_t grid_bytes = grid->memUsage();
    std::size_t brick_bytes = 0;
    const double brick_seconds = timesOf([&] { brick_bytes = march::makeBrickIntersector(*grid)->bytes(); }).wall;
    // Last, for it rounds what it writes.
    const std::size_t half_bytes = writtenBytes(grid, scratch, true, half_seconds);
    return {fmt::format("{:.9g}", lattice.voxel_size),
            std::to_string(active),
            std::to_string(leaves),
            std::to_string(tiles),
            std::to_string(grid_bytes),
            std::to_string(float_bytes),
            std::to_string(half_bytes),
            std::to_string(brick_bytes),
            fmt::format("{:.0f}", estimate),
            std::to_string(peak),
            fmt::format("{:.4f}", voxelize_seconds),
            fmt::format("{:.4f}", write_seconds),
            fmt::format("{:.4f}", brick_seconds),
            fmt::format("{:.6g}", part),
            kOk};
}

// In the child. The cells after the key.
std::string measure(const std::string& print, int count, std::string_view way, const fs::path& scratch, double budget,
                    int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
    openvdb::initialize();
    const gcode::Toolpath toolpath = readPrint(print);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, count);
    const double part = voxelize::depositedVolume(toolpath, beads);
    const Interior interior = way == kCull ? Interior::cull : Interior::keep;
    const double estimate = way == kStreamed ? 0 : voxelize::estimateBytes(toolpath, beads, lattice, interior);
    const std::string text =
        csvLine(way == kStreamed    ? measureStream(toolpath, beads, lattice, scratch, part)
                : estimate > budget ? leftOut(lattice, estimate, part)
                                    : measureGrid(toolpath, beads, lattice, interior, scratch, estimate, part));
    return text.substr(0, text.size() - 1);
}

using Points = std::vector<std::pair<double, double>>;

struct Curve {
    std::string print, interior;
    double part = 0;
    std::vector<const Row*> rows;  // coarse to fine

    Points of(std::size_t column, double scale = 1) const {
        Points points;
        for (const Row* row : rows)
            if (!row->at(column).empty()) points.emplace_back(numberIn(*row, kVoxel), scale * numberIn(*row, column));
        return points;
    }
};

std::vector<Curve> curvesOf(const ResultTable& table, const std::vector<std::pair<std::string, std::string>>& prints,
                            const std::vector<int>& counts) {
    std::vector<Curve> curves;
    for (const auto& [name, hash] : prints)
        for (const char* interior : kWays) {
            Curve curve{name, interior, 0, {}};
            for (const int count : counts) {
                const Row* row = table.find({name, hash, std::to_string(count), interior});
                if (row == nullptr || row->at(kStatus) != kOk) continue;
                curve.part = numberIn(*row, kPart);
                curve.rows.push_back(row);
            }
            if (!curve.rows.empty()) curves.push_back(std::move(curve));
        }
    return curves;
}

std::string mega(double bytes) { return fmt::format("{:.1f}", bytes * 1e-6); }

void addLaws(Page& page, const std::vector<Curve>& curves) {
    Row columns{"print",        "interior",    "what",     "exponent",     "finest mm",
                "predicted MB", "measured MB", "off by %", "next size mm", "prediction MB"};
    std::vector<Row> rows;
    const std::vector<std::pair<std::string, std::size_t>> kinds{{"memory", kGrid},
                                                                 {"disk, float", kFloatFile},
                                                                 {"disk, half", kHalfFile},
                                                                 {"bricks", kBricks},
                                                                 {"peak RSS", kPeak}};
    for (const Curve& curve : curves) {
        if (curve.rows.size() < 3) continue;
        for (const auto& [what, column] : kinds) {
            const Points points = curve.of(column);
            if (points.size() < 3) continue;
            const PowerLaw before = fitPowerLaw(std::span(points).first(points.size() - 1));
            const PowerLaw all = fitPowerLaw(points);
            const auto [finest, measured] = points.back();
            const double height = finest * numberIn(*curve.rows.back(), kCount);
            const double next = height / (numberIn(*curve.rows.back(), kCount) + 1);
            rows.push_back({curve.print, curve.interior, what, fmt::format("{:.2f}", all.exponent),
                            fmt::format("{:.4g}", finest), mega(before.at(finest)), mega(measured),
                            fmt::format("{:+.1f}", (before.at(finest) / measured - 1) * 100),
                            fmt::format("{:.4g}", next), mega(all.at(next))});
        }
    }
    page.heading("Power laws");
    page.paragraph(
        "bytes = a (voxel size)^exponent, by least squares of the logarithms over all sizes. \"Predicted\" is what the "
        "law says of the finest size when fitted to the coarser ones alone, beside what was then measured. The last "
        "column is the law of all sizes at one voxel a layer more, which nobody has measured here.");
    page.table(columns, rows);
}

void addPlots(Page& page, const std::vector<Curve>& curves) {
    std::set<std::string> drawn;
    for (const Curve& curve : curves) {
        if (!drawn.insert(curve.print).second) continue;
        Plot plot{curve.print, "voxel size, mm", "bytes", true, true, {}};
        for (const Curve& other : curves) {
            if (other.print != curve.print) continue;
            const bool cull = other.interior == kCull;
            const auto add = [&](const char* what, std::size_t column, int color) {
                Points points = other.of(column);
                if (points.empty()) return;
                // Without a grid the file is the same.
                if (other.interior == kStreamed && column != kPeak) return;
                plot.series.push_back({fmt::format("{}, {}", what, other.interior), std::move(points), cull, true,
                                       other.interior == kStreamed ? 5 : color});
            };
            add("grid", kGrid, 0);
            add("peak RSS", kPeak, 1);
            add("bricks", kBricks, 2);
            add("file, float", kFloatFile, 3);
            add("file, half", kHalfFile, 4);
        }
        page.plot(plot);
    }
    Plot each{
        "Memory of the grid for a cubic millimetre of plastic", "voxel size, mm", "bytes per mm\u00b3", true, true, {}};
    Plot time{"Time to voxelize, in a process of its own (fresh memory)", "voxel size, mm", "seconds", true, true, {}};
    int color = -1;
    std::string last;
    for (const Curve& curve : curves) {
        if (curve.print != last) ++color;
        last = curve.print;
        const std::string name = fmt::format("{}, {}", curve.print, curve.interior);
        if (curve.interior == kStreamed) continue;
        each.series.push_back({name, curve.of(kGrid, 1 / curve.part), curve.interior == kCull, true, color});
        time.series.push_back({name, curve.of(kVoxelizeSeconds), curve.interior == kCull, true, color});
    }
    page.plot(each);
    page.plot(time);
}

void writePage(const fs::path& path, const ResultTable& table, const std::vector<Curve>& curves,
               const std::vector<std::string>& command) {
    Page page("Memory against voxel size", command);
    page.paragraph(
        "Each configuration is a process of its own that reads the print, voxelizes, and writes; its peak is taken "
        "then. "
        "keep: all surfaces; cull: what the outside can reach; no grid: leaves go to the file while they are made, as "
        "gcode2vdb does where nothing needs a grid, so that voxelizing and writing are one. Bricks are what rays are "
        "traced through, built after "
        "that peak was read. A cubic millimetre of plastic is one that the nozzle has extruded.");
    addPlots(page, curves);
    addLaws(page, curves);
    page.heading("Everything measured");
    std::vector<Row> rows;
    std::vector<std::size_t> lines;
    for (const Row& row : table.rows()) {
        const bool ok = row[kStatus] == kOk;
        lines.push_back(table.lineOf(row));
        const auto with = [&](std::size_t column, double scale, const char* format) {
            return ok && !row[column].empty() ? fmt::format(fmt::runtime(format), numberIn(row, column) * scale)
                                              : std::string("\u2013");
        };
        rows.push_back({row[kPrint], row[kInterior], fmt::format("{:.4g}", numberIn(row, kVoxel)),
                        with(kActive, 1e-6, "{:.2f}"), with(kLeaves, 1e-3, "{:.1f}"), with(kTiles, 1, "{:.0f}"),
                        with(kGrid, 1e-6, "{:.1f}"), with(kEstimate, 1e-6, "{:.0f}"), with(kPeak, 1e-6, "{:.1f}"),
                        with(kFloatFile, 1e-6, "{:.1f}"), with(kHalfFile, 1e-6, "{:.1f}"),
                        with(kBricks, 1e-6, "{:.1f}"), with(kGrid, 1 / numberIn(row, kPart), "{:.0f}"),
                        with(kVoxelizeSeconds, 1, "{:.3f}"), with(kWriteSeconds, 1, "{:.3f}"), row[kStatus],
                        row.back()});
    }
    page.table({"print", "interior", "voxel mm", "active, M", "leaves, k", "active tiles", "grid MB", "estimate MB",
                "peak RSS MB", "float file MB", "half file MB", "bricks MB", "grid bytes per mm\u00b3", "voxelize s",
                "write s", "status", "run"},
               rows, {}, lines, "memory");
    page.runs(table);
    page.write(path);
}

}  // namespace

StudyReport studyMemory(const MemoryOptions& options, const StudyOptions& common) {
    std::vector<int> counts = options.voxels_per_layer;
    if (counts.empty()) counts = common.quick ? std::vector<int>{1, 2, 3} : std::vector<int>{1, 2, 3, 4};
    std::sort(counts.begin(), counts.end());
    std::vector<std::pair<std::string, std::string>> prints;
    for (const std::string& print : options.prints)
        prints.emplace_back(fs::path(print).filename().string(), shortHash(print));
    ResultTable table(common, "memory.csv", kColumns, kKeys);
    const fs::path scratch = common.folder / fmt::format(".memory-{}.vdb", ::getpid());
    const std::size_t all = prints.size() * counts.size() * kWays.size();
    std::size_t done = 0;
    StudyReport report;
    for (std::size_t p = 0; p < prints.size(); ++p)
        for (const int count : counts)
            for (const std::string kind : kWays) {
                const Row key{prints[p].first, prints[p].second, std::to_string(count), kind};
                if (table.find(key) == nullptr) {
                    const Outcome outcome = inOwnProcess([&] {
                        return measure(options.prints[p], count, kind, scratch, options.memory_share * availableBytes(),
                                       common.threads);
                    });
                    std::error_code ignored;
                    fs::remove(scratch, ignored);
                    if (!outcome.failure.empty())
                        throw InputError(fmt::format("{}: {} voxels a layer, {}: {}", options.prints[p], count, kind,
                                                     outcome.failure));
                    Row row = key;
                    const Row measured = parseCsvLine(outcome.text);
                    row.insert(row.end(), measured.begin(), measured.end());
                    table.add(std::move(row));
                }
                if (const Row& row = *table.find(key); row[kStatus] != kOk)
                    report.findings.push_back(
                        fmt::format("{} at {} mm, {}: {}", row[kPrint], row[kVoxel], kind, row[kStatus]));
                if (common.progress) common.progress(static_cast<double>(++done) / static_cast<double>(all));
            }
    report.csv = table.path();
    report.html = common.folder / "memory.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    writePage(report.html, table, curvesOf(table, prints, counts), common.command);
    return report;
}

}  // namespace stratum::study
