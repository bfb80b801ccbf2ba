#include "study/geometry/surface_error.h"

#include "corpus.h"
#include "march/brick/brick_intersector.h"
#include "scratch_folder.h"
#include "study/geometry/exact_solid.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/print.h"
#include "study/report/table.h"
#include "study/study.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxel_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace stratum::study {
namespace {

TEST(Spread, IsWhatItsNameSays) {
    const Spread s = spreadOf({3, 1, 2, 4});
    EXPECT_DOUBLE_EQ(s.mean, 2.5);
    EXPECT_DOUBLE_EQ(s.rms, std::sqrt(7.5));
    EXPECT_DOUBLE_EQ(s.max, 4);
    EXPECT_DOUBLE_EQ(spreadOf({}).max, 0);
}

// A bead's flats lie on voxel planes and are met exactly; its rounding is off by no more than a chord of it.
TEST(SurfaceError, OfASingleBead) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.6, 0.2);
    const ExactSolid exact(toolpath, allBeads(toolpath), 0.3);
    const auto points = exact.samplePoints(5000);
    double last = 1;
    for (const double voxel : {0.1, 0.05, 0.025}) {
        const auto level_set =
            march::makeBrickIntersector(*voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(voxel, 0.2)));
        const SurfaceError error = surfaceError(*level_set, points, 2 * voxel);
        EXPECT_EQ(error.lost_share, 0);
        EXPECT_LT(error.distance.max, 0.5 * voxel);
        EXPECT_LT(error.distance.mean, last / 3);  // second order, or nearly
        last = error.distance.mean;
        EXPECT_LT(error.angle.mean, 60 * voxel);  // degrees
        EXPECT_LT(error.angle.max, 60);
        EXPECT_LT(backwardError(*level_set, exact, 2000).max, 0.5 * voxel);
    }
}

// Points that were moved away by a known distance are that far from the level set, and no farther.
TEST(SurfaceError, MeasuresAKnownDistance) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 3, 0, 0.2, 0.6, 0.2);
    auto points = ExactSolid(toolpath, allBeads(toolpath), 0.3).samplePoints(5000);
    for (auto& p : points) p.position += 0.07 * p.normal;
    const auto level_set =
        march::makeBrickIntersector(*voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.01, 0.2)));
    const SurfaceError error = surfaceError(*level_set, points, 0.2);
    EXPECT_NEAR(error.distance.mean, 0.07, 2e-4);
    EXPECT_LT(error.distance.max, 0.0712);
    // Nothing within a tenth of that: all are lost.
    EXPECT_EQ(surfaceError(*level_set, points, 0.007).lost_share, 1);
}

// What --tolerance promises, both ways: see voxelize/voxel_choice.h.
TEST(SurfaceError, OfAPrintStaysBelowTheTwoBounds) {
    openvdb::initialize();
    const gcode::Toolpath toolpath = readPrint((test::dataDir() / "gcode" / "knot.gcode").string());
    voxelize::Selection selection;
    voxelize::parseLayers("3:8", selection);
    const auto beads = voxelize::selectBeads(toolpath, selection);
    const ExactSolid exact(toolpath, beads, 0.3);
    const auto points = exact.samplePoints(6000);
    for (const int per_layer : {2, 3, 4}) {
        const voxelize::Lattice lattice = latticeOf(toolpath, beads, per_layer);
        const auto level_set = march::makeBrickIntersector(*voxelize::voxelize(toolpath, beads, lattice));
        std::vector<ExactSolid::SurfacePoint> open;
        for (const auto& point : points)
            if (exact.clearance(point, 2 * lattice.voxel_size) >= 2 * lattice.voxel_size) open.push_back(point);
        ASSERT_GT(open.size(), 500U);
        const SurfaceError there = surfaceError(*level_set, open, 8 * lattice.voxel_size);
        EXPECT_EQ(there.lost_share, 0) << per_layer;
        EXPECT_LT(there.distance.p999, voxelize::kLargestMissVoxels * lattice.voxel_size) << per_layer;
        // Slits that are open where the point lies and close beside it.
        EXPECT_LT(there.distance.max, 2.5 * lattice.voxel_size) << per_layer;
        const Spread back = backwardError(*level_set, exact, points.size());
        EXPECT_LT(back.max, voxelize::kLargestErrorVoxels * lattice.voxel_size) << per_layer;
    }
}

TEST(Geometry, WritesATable) {
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path(), .quick = true};
    const GeometryOptions options{(test::dataDir() / "gcode" / "tile.gcode").string(), "1:4", {1, 2}, 500};
    const StudyReport report = studyGeometry(options, common);
    EXPECT_EQ(report.rows, 9U);  // two of each lattice, two half-widths, one of halves, two of settled beads
    std::ifstream file(report.csv);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(parseCsvLine(line));
    const auto at = [&](std::size_t row, const char* column) {
        const auto place = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
        return std::stod(rows.at(row).at(static_cast<std::size_t>(place)));
    };
    EXPECT_LT(at(2, "mean_mm"), at(1, "mean_mm"));
    EXPECT_LT(std::abs(at(2, "volume_error_mm3")), 0.1 * at(2, "exact_mm3"));
    // Settled beads are held against their own solid, which is larger than the union.
    EXPECT_EQ(rows.at(9).at(4), "settled");
    EXPECT_GT(at(9, "exact_mm3"), 1.005 * at(2, "exact_mm3"));
    EXPECT_LT(std::abs(at(9, "volume_error_mm3")), 0.02 * at(9, "exact_mm3"));
    EXPECT_LT(at(9, "mean_mm"), at(8, "mean_mm"));
}

}  // namespace
}  // namespace stratum::study
