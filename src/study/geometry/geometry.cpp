#include "study/geometry/geometry.h"

#include "base/parallel_for.h"
#include "march/brick/brick_intersector.h"
#include "study/cost/times.h"
#include "study/geometry/settled_solid.h"
#include "study/geometry/union_field.h"
#include "study/print.h"
#include "study/report/page.h"
#include "study/report/power_law.h"
#include "study/report/result_table.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/enclosed_volume.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/ValueTransformer.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string_view>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print",
                   "sha256",
                   "layers",
                   "points",
                   "beads_are",
                   "lattice",
                   "per_layer",
                   "half_width",
                   "precision",
                   "voxel_mm",
                   "narrow_share",
                   "lost_share",
                   "mean_mm",
                   "rms_mm",
                   "p999_mm",
                   "max_mm",
                   "angle_mean_deg",
                   "angle_rms_deg",
                   "angle_p999_deg",
                   "angle_max_deg",
                   "back_mean_mm",
                   "back_p999_mm",
                   "back_max_mm",
                   "exact_mm3",
                   "volume_error_mm3",
                   "volume_error_sigma_mm3",
                   "stats_volume_mm3",
                   "seconds",
                   "grid_bytes"};
constexpr std::size_t kKeys = 9;
enum Column : std::size_t {
    kPrint,
    kHash,
    kLayers,
    kPoints,
    kBeadsAre,
    kLattice,
    kPerLayer,
    kHalfWidth,
    kPrecision,
    kVoxel,
    kNarrow,
    kLost,
    kMean,
    kRms,
    kP999,
    kMax,
    kAngleMean,
    kAngleRms,
    kAngleP999,
    kAngleMax,
    kBackMean,
    kBackP999,
    kBackMax,
    kExact,
    kVolumeError,
    kVolumeSigma,
    kStatsVolume,
    kSeconds,
    kBytes
};
constexpr const char* kUnion = "union";
constexpr const char* kSettled = "settled";
constexpr const char* kAligned = "aligned";
constexpr const char* kShifted = "half a voxel off";

struct Configuration {
    const char* lattice;
    double per_layer;
    double half_width = 3;
    const char* precision = "float";
    const char* beads_are = kUnion;
};

std::vector<Configuration> configurationsFor(const std::vector<double>& counts, bool quick) {
    std::vector<Configuration> all;
    for (const char* lattice : {kAligned, kShifted})
        for (const double count : counts) all.push_back({lattice, count});
    const double middle = counts[counts.size() / 2];
    for (const double half_width : {2.0, 5.0}) all.push_back({kAligned, middle, half_width});
    for (const double count : counts)
        if (!quick || count == middle) all.push_back({kAligned, count, 3, "half"});
    for (const double count : counts) all.push_back({kAligned, count, 3, "float", kSettled});
    return all;
}

// As a file of --precision half gives the values back.
void roundToHalves(openvdb::FloatGrid& grid) {
    const auto round = [](float v) { return static_cast<float>(openvdb::math::half(v)); };
    openvdb::tools::foreach (grid.beginValueOn(),
                             [&](const openvdb::FloatGrid::ValueOnIter& v) { v.setValue(round(*v)); });
}

struct Subject {
    gcode::Toolpath toolpath;
    std::vector<std::uint32_t> beads;
    voxelize::Lattice one_per_layer;
    std::unique_ptr<ExactSolid> exact;
    std::vector<ExactSolid::SurfacePoint> points;
    std::vector<double> clearance;  // in front of each
    std::size_t volume_points = 0;
};

// How much empty space a point must have in front for the grid to be asked for its surface, voxels.
constexpr double kResolved = 2;

// In place: the exact solid refers to the toolpath.
void prepare(Subject& subject, const GeometryOptions& options, std::string_view beads_are, std::size_t points,
             double fewest_per_layer, bool quick) {
    subject.toolpath = readPrint(options.print);
    if (beads_are == kSettled) subject.toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    voxelize::Selection selection;
    if (!options.layers.empty()) voxelize::parseLayers(options.layers, selection);
    // Of sloped beads the field's ends are approximate: there is nothing exact to compare with.
    for (const std::uint32_t index : voxelize::selectBeads(subject.toolpath, selection))
        if (subject.toolpath.beads[index].z0 == subject.toolpath.beads[index].z1) subject.beads.push_back(index);
    subject.one_per_layer = latticeOf(subject.toolpath, subject.beads, 1);
    // Back onto the layers' planes, which this study compares with those half a voxel off at every size.
    subject.one_per_layer.origin_z -= 0.5 * subject.one_per_layer.voxel_size;
    const double reach = 1.5 * subject.one_per_layer.layer_height;
    if (beads_are == kSettled)
        subject.exact = std::make_unique<SettledSolid>(subject.toolpath, subject.beads, reach);
    else
        subject.exact = std::make_unique<UnionField>(subject.toolpath, subject.beads, reach);
    subject.points = subject.exact->samplePoints(points);
    subject.clearance.resize(points);
    parallelFor(points, 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n)
            subject.clearance[n] = subject.exact->clearance(
                subject.points[n], kResolved * subject.one_per_layer.layer_height / fewest_per_layer);
    });
    subject.volume_points = quick ? std::size_t{1} << 15 : std::size_t{1} << 18;
}

Row measure(const Subject& subject, const Configuration& c, int runs) {
    voxelize::Lattice lattice = subject.one_per_layer;
    lattice.voxel_size = lattice.layer_height / c.per_layer;
    lattice.half_width = c.half_width;
    if (c.lattice == kShifted) lattice.origin_z += 0.5 * lattice.voxel_size;
    openvdb::FloatGrid::Ptr grid;
    std::vector<double> seconds;
    seconds.reserve(static_cast<std::size_t>(runs));
    for (int run = 0; run < runs; ++run)
        seconds.push_back(timesOf([&] { grid = voxelize::voxelize(subject.toolpath, subject.beads, lattice); }).wall);
    std::sort(seconds.begin(), seconds.end());
    if (std::string_view(c.precision) == "half") roundToHalves(*grid);
    const double stats_volume = voxelize::enclosedVolume(*grid);
    const ExactSolid::Volume volume = subject.exact->volume(subject.volume_points, [&grid]() -> ExactSolid::Inside {
        return [accessor = grid->getConstAccessor(), &grid](const glm::dvec3& p) {
            const openvdb::Vec3d at = grid->worldToIndex(openvdb::Vec3d(p.x, p.y, p.z));
            return openvdb::tools::BoxSampler::sample(accessor, at) < 0;
        };
    });
    const std::size_t bytes = grid->memUsage();
    const auto intersector = march::makeBrickIntersector(*grid);
    grid.reset();
    std::vector<ExactSolid::SurfacePoint> open;
    for (std::size_t n = 0; n < subject.points.size(); ++n)
        if (subject.clearance[n] >= kResolved * lattice.voxel_size) open.push_back(subject.points[n]);
    const double narrow_share = 1 - static_cast<double>(open.size()) / static_cast<double>(subject.points.size());
    // Far beyond any error that such a point may have, so that "largest" is the error's and not the search's.
    const SurfaceError error = surfaceError(*intersector, open, 8 * lattice.voxel_size);
    const Spread back = backwardError(*intersector, *subject.exact, subject.points.size());
    Row row{fmt::format("{:.9g}", lattice.voxel_size)};
    for (const double v : {narrow_share, error.lost_share, error.distance.mean, error.distance.rms, error.distance.p999,
                           error.distance.max, error.angle.mean, error.angle.rms, error.angle.p999, error.angle.max,
                           back.mean, back.p999, back.max})
        row.push_back(fmt::format("{:.5g}", v));
    for (const double v : {volume.value, volume.excess, volume.excess_error, stats_volume})
        row.push_back(fmt::format("{:.6g}", v));
    row.push_back(fmt::format("{:.4g}", seconds[seconds.size() / 2]));
    row.push_back(std::to_string(bytes));
    return row;
}

using Points = std::vector<std::pair<double, double>>;

// What the plots compare: all with a half-width of 3.
struct Kind {
    const char* beads_are;
    const char* lattice;
    const char* name;
};
constexpr std::array<Kind, 3> kKinds{
    {{kUnion, kAligned, "union"}, {kUnion, kShifted, "union, shifted"}, {kSettled, kAligned, "settled"}}};

bool isOf(const Row& row, const Kind& kind) {
    return row[kBeadsAre] == kind.beads_are && row[kLattice] == kind.lattice && row[kPrecision] == "float" &&
           numberIn(row, kHalfWidth) == 3;
}

using ValueOfRow = std::function<double(const Row&)>;

Points pointsOf(const std::vector<Row>& rows, const Kind& kind, std::size_t x, const ValueOfRow& y) {
    Points points;
    for (const Row& row : rows)
        if (isOf(row, kind)) points.emplace_back(numberIn(row, x), y(row));
    return points;
}

ValueOfRow cell(std::size_t column) {
    return [column](const Row& row) { return numberIn(row, column); };
}

// Of all points of the exact surface: those in what is too narrow for the voxels, and those without a zero nearby.
double notThere(const Row& row) { return numberIn(row, kNarrow) + (1 - numberIn(row, kNarrow)) * numberIn(row, kLost); }

using Shown = std::vector<std::pair<const char*, std::size_t>>;

void addPlots(Page& page, const std::vector<Row>& rows) {
    const auto against = [&](const char* title, const char* x_label, const char* y_label, std::size_t x,
                             const Shown& shown) {
        Plot plot{title, x_label, y_label, true, true, {}};
        for (std::size_t k = 0; k < kKinds.size(); ++k)
            for (std::size_t n = 0; n < shown.size(); ++n)
                plot.series.push_back({fmt::format("{}, {}", shown[n].first, kKinds[k].name),
                                       pointsOf(rows, kKinds[k], x, cell(shown[n].second)), k == 1, true,
                                       static_cast<int>(n + (k == 2 ? shown.size() : 0))});
        page.plot(plot);
    };
    const Shown there{{"mean", kMean}, {"99.9 %", kP999}, {"largest", kMax}};
    const Shown back{{"mean", kBackMean}, {"99.9 %", kBackP999}, {"largest", kBackMax}};
    const Shown both{{"there, mean", kMean}, {"back, mean", kBackMean}};
    against("There: from the exact surface to the level set", "voxel size, mm", "distance, mm", kVoxel, there);
    against("Back: from the level set to the exact surface", "voxel size, mm", "distance, mm", kVoxel, back);
    Plot lost{"Not there: of the exact surface, what the level set does not show",
              "voxel size, mm",
              "share",
              true,
              false,
              {}};
    for (const Kind& kind : kKinds) lost.series.push_back({kind.name, pointsOf(rows, kind, kVoxel, notThere)});
    page.plot(lost);
    against("Between their normals", "voxel size, mm", "angle, degrees", kVoxel,
            {{"mean", kAngleMean}, {"99.9 %", kAngleP999}});
    against("Error against run time", "seconds to voxelize", "distance, mm", kSeconds, both);
    Plot volume{"Volume", "voxel size, mm", "|error|, share of the volume", true, true, {}};
    for (const Kind& kind : kKinds) {
        Series series{kind.name, {}, std::string_view(kind.lattice) == kShifted};
        for (const Row& row : rows) {
            if (!isOf(row, kind)) continue;
            const double whole = numberIn(row, kExact);
            const double off = std::abs(numberIn(row, kVolumeError)) / whole;
            const double sigma = numberIn(row, kVolumeSigma) / whole;
            series.points.emplace_back(numberIn(row, kVoxel), off);
            series.bars.emplace_back(off - sigma, off + sigma);
        }
        volume.series.push_back(std::move(series));
    }
    page.plot(volume);
}

void addOrders(Page& page, const std::vector<Row>& rows) {
    std::vector<Row> cells;
    for (const Kind& kind : kKinds)
        for (const auto& [name, column] : Shown{{"mean distance", kMean},
                                                {"RMS distance", kRms},
                                                {"mean distance, back", kBackMean},
                                                {"largest distance, back", kBackMax},
                                                {"mean angle", kAngleMean},
                                                {"RMS angle", kAngleRms}}) {
            const PowerLaw law = fitPowerLaw(pointsOf(rows, kind, kVoxel, cell(column)));
            const PowerLaw time = fitPowerLaw(pointsOf(rows, kind, kSeconds, cell(column)));
            cells.push_back({kind.name, name, fmt::format("{:.2f}", law.exponent),
                             fmt::format("{:.0f}", 100 * law.worst), fmt::format("{:.2f}", time.exponent),
                             fmt::format("{:.0f}", 100 * time.worst)});
        }
    page.heading("Orders of convergence");
    page.paragraph(
        "Exponents of the voxel size and of the time, by least squares of the logarithms, each with how far the law is "
        "from the worst of its own points.");
    page.table({"beads, lattice", "error", "order in the voxel size", "worst point off by %", "order in time",
                "worst point off by %"},
               cells);
}

void writePage(const fs::path& path, const ResultTable& table, const std::vector<Row>& rows,
               const std::vector<std::string>& command) {
    Page page("Geometric error against voxel size and time", command);
    page.paragraph(fmt::format(
        "{}, {} points spread evenly by area over the exact surface of its level beads, as their union and as settled "
        "beads (--beads settled), inner surfaces included, in double. Beads side by side leave gaps that narrow down "
        "to nothing, and most of the area of a "
        "solid layer is such: no grid holds what is thinner than its voxels. \"Narrow\" is the share of points with "
        "less than {:g} voxels of empty space in front, along their normal. From "
        "each of the others the nearest zero of the trilinear level set that rays through bricks find, as far as 8 "
        "voxels away; \"lost\" are those without one. Both are not there: a voxel that is too coarse has small "
        "distances only because of "
        "what it leaves out. Angles near 180 degrees are zeros of a wall that faces the "
        "other way: at a crease between two beads, or where a thin spot of empty space is closed. \"Back\" are hits "
        "of rays from outside and their distance to the exact surface. Volumes are counted at quasi-random points, in "
        "the trilinear field and in the exact solid, with the standard error of the difference; beside it what "
        "--stats reports. Seconds are the median of three builds. Lattices are aligned with the layers; \"shifted\" "
        "ones are "
        "half a voxel off.",
        rows.front()[kPrint], rows.front()[kPoints], kResolved));
    addPlots(page, rows);
    addOrders(page, rows);
    page.heading("Everything measured");
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const Row& row : rows) {
        Row line{row[kBeadsAre], row[kLattice], row[kPerLayer], row[kHalfWidth], row[kPrecision]};
        for (std::size_t column = kVoxel; column <= kBackMax; ++column)
            line.push_back(fmt::format("{:.3g}", numberIn(row, column)));
        line.insert(line.begin() + 8, fmt::format("{:.3g}", notThere(row)));
        for (const double v : {numberIn(row, kVolumeError), numberIn(row, kVolumeSigma),
                               numberIn(row, kStatsVolume) - numberIn(row, kExact)})
            line.push_back(fmt::format("{:.3f}", v / numberIn(row, kExact) * 100));
        line.push_back(fmt::format("{:.3f}", numberIn(row, kSeconds)));
        line.push_back(fmt::format("{:.1f}", numberIn(row, kBytes) * 1e-6));
        line.push_back(row.back());
        lines.push_back(table.lineOf(row));
        cells.push_back(std::move(line));
    }
    page.table({"beads are",
                "lattice",
                "voxels a layer",
                "half-width",
                "precision",
                "voxel mm",
                "narrow",
                "lost",
                "not there",
                "mean mm",
                "RMS mm",
                "99.9 % mm",
                "max mm",
                "mean \u00b0",
                "RMS \u00b0",
                "99.9 % \u00b0",
                "max \u00b0",
                "back mean mm",
                "back 99.9 % mm",
                "back max mm",
                "volume %",
                "\u00b1 %",
                "s",
                "MB",
                "run"},
               cells, {}, lines, "geometry");
    page.runs(table);
    page.write(path);
}

}  // namespace

StudyReport studyGeometry(const GeometryOptions& options, const StudyOptions& common) {
    openvdb::initialize();
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(common.threads > 0 ? common.threads : tbb::info::default_concurrency()));
    std::vector<double> counts = options.counts;
    if (counts.empty()) counts = common.quick ? std::vector<double>{1, 2, 4} : std::vector<double>{1, 2, 3, 4, 6, 8};
    std::sort(counts.begin(), counts.end());
    const std::size_t points = options.points > 0 ? options.points : common.quick ? 4000 : 40000;
    ResultTable table(common, "geometry.csv", kColumns, kKeys);
    const std::string name = fs::path(options.print).filename().string();
    const std::string hash = shortHash(options.print);
    std::unique_ptr<Subject> subject;  // made only if something is left to measure
    std::string subject_is;
    std::vector<Row> rows;
    const std::vector<Configuration> all = configurationsFor(counts, common.quick);
    for (std::size_t n = 0; n < all.size(); ++n) {
        const Configuration& c = all[n];
        Row key{name,
                hash,
                options.layers.empty() ? "all" : options.layers,
                std::to_string(points),
                c.beads_are,
                c.lattice,
                fmt::format("{:g}", c.per_layer),
                fmt::format("{:g}", c.half_width),
                c.precision};
        if (table.find(key) == nullptr) {
            if (!subject || subject_is != c.beads_are) {
                subject = std::make_unique<Subject>();
                subject_is = c.beads_are;
                prepare(*subject, options, subject_is, points, counts.front(), common.quick);
            }
            Row row = key;
            const Row measured = measure(*subject, c, common.quick ? 1 : 3);
            row.insert(row.end(), measured.begin(), measured.end());
            table.add(std::move(row));
        }
        rows.push_back(*table.find(key));
        if (common.progress) common.progress(static_cast<double>(n + 1) / static_cast<double>(all.size()));
    }
    StudyReport report;
    report.csv = table.path();
    report.html = common.folder / "geometry.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    writePage(report.html, table, rows, common.command);
    return report;
}

}  // namespace stratum::study
