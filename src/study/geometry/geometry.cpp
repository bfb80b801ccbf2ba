#include "study/geometry/surface_error.h"

#include "base/parallel_for.h"
#include "march/brick/brick_intersector.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "study/report/page.h"
#include "study/report/power_law.h"
#include "study/study.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/ValueTransformer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string_view>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColumns =
    "print,sha256,layers,points,beads_are,lattice,per_layer,half_width,precision,voxel_mm,narrow_share,"
    "lost_share,mean_mm,rms_mm,p999_mm,max_mm,angle_mean_deg,angle_rms_deg,angle_p999_deg,angle_max_deg,"
    "back_mean_mm,back_p999_mm,back_max_mm,exact_mm3,volume_error_mm3,volume_error_sigma_mm3,stats_volume_mm3,"
    "seconds,grid_bytes";
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
    subject.exact = std::make_unique<ExactSolid>(subject.toolpath, subject.beads, reach);
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
    Row row = figures({lattice.voxel_size, narrow_share, error.lost_share});
    for (const Spread& s : {error.distance, error.angle}) row = joined(row, figures({s.mean, s.rms, s.p999, s.max}));
    return joined(row, figures({back.mean, back.p999, back.max, volume.value, volume.excess, volume.excess_error,
                                stats_volume, median(seconds), static_cast<double>(bytes)}));
}

using Points = std::vector<std::pair<double, double>>;

// What the plots compare: all with a half-width of 3, in floats.
struct Kind {
    const char* beads_are;
    const char* lattice;
    const char* name;
};
constexpr std::array<Kind, 3> kKinds{
    {{kUnion, kAligned, "union"}, {kUnion, kShifted, "union, shifted"}, {kSettled, kAligned, "settled"}}};

using ValueOfRow = std::function<double(const Row&)>;

Points pointsOf(const Table& table, const Kind& kind, const char* x, const ValueOfRow& y) {
    Points points;
    for (const Row& row : table.rows())
        if (table.text(row, "beads_are") == kind.beads_are && table.text(row, "lattice") == kind.lattice &&
            table.text(row, "precision") == "float" && table.number(row, "half_width") == 3)
            points.emplace_back(table.number(row, x), y(row));
    return points;
}

Points pointsOf(const Table& table, const Kind& kind, const char* x, const char* y) {
    return pointsOf(table, kind, x, [&](const Row& row) { return table.number(row, y); });
}

using Shown = std::vector<std::pair<const char*, const char*>>;

void addPlots(Page& page, const Table& table) {
    const auto against = [&](const char* title, const char* x_label, const char* y_label, const char* x,
                             const Shown& shown) {
        Plot plot{title, x_label, y_label, true, true, {}};
        for (std::size_t k = 0; k < kKinds.size(); ++k)
            for (std::size_t n = 0; n < shown.size(); ++n)
                plot.series.push_back({fmt::format("{}, {}", shown[n].first, kKinds[k].name),
                                       pointsOf(table, kKinds[k], x, shown[n].second), k == 1, true,
                                       static_cast<int>(n + (k == 2 ? shown.size() : 0))});
        page.plot(plot);
    };
    const char* const voxel = "voxel size, mm";
    against("There: from the exact surface to the level set", voxel, "distance, mm", "voxel_mm",
            {{"mean", "mean_mm"}, {"99.9 %", "p999_mm"}, {"largest", "max_mm"}});
    against("Back: from the level set to the exact surface", voxel, "distance, mm", "voxel_mm",
            {{"mean", "back_mean_mm"}, {"99.9 %", "back_p999_mm"}, {"largest", "back_max_mm"}});
    Plot lost{"Not there: of the exact surface, what the level set does not show", voxel, "share", true, false, {}};
    Plot volume{"Volume", voxel, "|error|, share of the volume", true, true, {}};
    for (const Kind& kind : kKinds) {
        // In what is too narrow for the voxels, and without a zero nearby.
        lost.series.push_back({kind.name, pointsOf(table, kind, "voxel_mm", [&](const Row& row) {
                                   const double narrow = table.number(row, "narrow_share");
                                   return narrow + (1 - narrow) * table.number(row, "lost_share");
                               })});
        volume.series.push_back({kind.name, pointsOf(table, kind, "voxel_mm", [&](const Row& row) {
                                     return std::abs(table.number(row, "volume_error_mm3")) /
                                            table.number(row, "exact_mm3");
                                 })});
    }
    page.plot(lost);
    against("Between their normals", voxel, "angle, degrees", "voxel_mm",
            {{"mean", "angle_mean_deg"}, {"99.9 %", "angle_p999_deg"}});
    against("Error against run time", "seconds to voxelize", "distance, mm", "seconds",
            {{"there, mean", "mean_mm"}, {"back, mean", "back_mean_mm"}});
    page.plot(volume);
}

void addOrders(Page& page, const Table& table) {
    std::vector<Row> cells;
    for (const Kind& kind : kKinds)
        for (const char* column :
             {"mean_mm", "rms_mm", "back_mean_mm", "back_max_mm", "angle_mean_deg", "angle_rms_deg"}) {
            const PowerLaw law = fitPowerLaw(pointsOf(table, kind, "voxel_mm", column));
            const PowerLaw time = fitPowerLaw(pointsOf(table, kind, "seconds", column));
            cells.push_back({kind.name, column, fmt::format("{:.2f}", law.exponent),
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

}  // namespace

StudyReport studyGeometry(const GeometryOptions& options, const StudyOptions& common) {
    openvdb::initialize();
    const tbb::global_control limit = limitThreads(common.threads);
    std::vector<double> counts = options.counts;
    if (counts.empty()) counts = common.quick ? std::vector<double>{1, 2, 4} : std::vector<double>{1, 2, 3, 4, 6, 8};
    std::sort(counts.begin(), counts.end());
    const std::size_t points = options.points > 0 ? options.points : common.quick ? 4000 : 40000;
    Table table(kColumns);
    const std::string name = fs::path(options.print).filename().string();
    const std::string hash = shortHash(options.print);
    std::unique_ptr<Subject> subject;
    std::string subject_is;
    const std::vector<Configuration> all = configurationsFor(counts, common.quick);
    for (const Configuration& c : all) {
        if (subject_is != c.beads_are) {
            subject_is = c.beads_are;
            subject = std::make_unique<Subject>();
            prepare(*subject, options, subject_is, points, counts.front(), common.quick);
        }
        table.add(
            joined({name, hash, options.layers.empty() ? "all" : options.layers, std::to_string(points), c.beads_are,
                    c.lattice, fmt::format("{:g}", c.per_layer), fmt::format("{:g}", c.half_width), c.precision},
                   measure(*subject, c, common.quick ? 1 : 3)));
        common.tell(table.rows().size(), all.size());
    }
    Page page("Geometric error against voxel size and time", common.command);
    page.paragraph(fmt::format(
        "{}, {} points spread evenly by area over the exact surface of its level beads, as their union and as settled "
        "beads (--beads settled), inner surfaces included, in double. Beads side by side leave gaps that narrow down "
        "to nothing, and most of the area of a solid layer is such: no grid holds what is thinner than its voxels. "
        "\"Narrow\" is the share of points with less than {:g} voxels of empty space in front, along their normal. "
        "From each of the others the nearest zero of the trilinear level set that rays through bricks find, as far as "
        "8 voxels away; \"lost\" are those without one. Both are not there: a voxel that is too coarse has small "
        "distances only because of what it leaves out. Angles near 180 degrees are zeros of a wall that faces the "
        "other way: at a crease between two beads, or where a thin spot of empty space is closed. \"Back\" are hits "
        "of rays from outside and their distance to the exact surface. Volumes are counted at quasi-random points, in "
        "the trilinear field and in the exact solid, with the standard error of the difference; beside it what "
        "--stats reports. Seconds are the median of three builds. Lattices are aligned with the layers; \"shifted\" "
        "ones are half a voxel off.",
        name, points, kResolved));
    addPlots(page, table);
    addOrders(page, table);
    page.heading("Everything measured");
    page.table(table);
    StudyReport report;
    writeTable(common, "geometry", table, report);
    writePage(common, "geometry", page, report);
    return report;
}

}  // namespace stratum::study
