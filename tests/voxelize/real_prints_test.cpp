// The voxelizer on real prints, against brute force over all their beads.
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "print_points.h"
#include "toolpaths.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <atomic>

namespace stratum::voxelize {
namespace {

struct Print {
    const char* name;
    const char* path;    // below data/gcode or the corpus's gcode
    const char* layers;  // as for --layers; keeps the oracle's run short
    bool corpus;
};

// mm; far above the rounding of doubles at these coordinates, far below any wedge of air.
constexpr double kNudge = 1e-11;
// So deep is a point by that much below a flat. At a micrometre's fraction from the flat's edge it is less.
constexpr double kFlat = 0.95 * kNudge;

class RealPrint : public testing::TestWithParam<Print> {};

INSTANTIATE_TEST_SUITE_P(
    Prints, RealPrint,
    testing::Values(Print{"hull", "hull.gcode", "1:40", false}, Print{"gear", "gear.gcode", "1:", false},
                    Print{"tile_arcs", "tile_arcs.gcode", "1:", false},
                    Print{"benchy_slic3r", "gcode-preview-benchy_slic3r.gcode", "1:60", true},
                    Print{"arcs_prusaslicer", "preprocess_cancellation-prusaslicer.gcode", "1:", true},
                    Print{"arcs_superslicer", "preprocess_cancellation-superslicer.gcode", "1:", true},
                    Print{"cura", "preprocess_cancellation-cura.gcode", "1:", true}),
    [](const auto& print) { return std::string(print.param.name); });

TEST_P(RealPrint, GridAgreesWithBruteForceAndIsSolidInside) {
    const Print& print = GetParam();
    const auto path = (print.corpus ? test::corpusDir() / "gcode" : test::dataDir() / "gcode") / print.path;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "corpus file " << print.path << " is not there";
    const InputFile file(path);
    const gcode::Toolpath whole = gcode::readToolpath(file.bytes(), print.path);
    EXPECT_NEAR(gcode::beadVolume(whole), whole.extruded_mm3, 1e-3 * whole.extruded_mm3);
    Selection selection;
    parseLayers(print.layers, selection);
    const gcode::Toolpath toolpath = test::levelPart(whole, selectBeads(whole, selection));
    const auto beads = test::allBeads(toolpath);
    const test::BruteForce brute(toolpath);

    for (const double voxel : {0.1, 0.05}) {
        LatticeRequest request;
        request.voxel_size = voxel;
        const Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
        const auto grid = voxelize(toolpath, beads, lattice);
        EXPECT_EQ(openvdb::tools::checkLevelSet(*grid, 8), "");

        // Active voxels drawn at random, the same for every run.
        constexpr std::size_t kPoints = 120000;
        const auto points = test::randomActiveVoxels(*grid, kPoints);
        std::atomic<std::size_t> outside{0};
        std::atomic<std::size_t> inside{0};
        std::atomic<std::size_t> interfaces{0};
        std::atomic<std::size_t> wrong{0};
        std::atomic<std::size_t> open{0};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size()), [&](const auto& range) {
            const auto accessor = grid->getConstAccessor();
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                const openvdb::Vec3d p = grid->indexToWorld(points[n]);
                const double expected = brute(p[0], p[1], p[2]);
                const auto value = static_cast<double>(accessor.getValue(points[n]));
                if (expected > 1e-7) {
                    ++outside;
                    if (std::abs(value - expected) > 2e-5) ++wrong;
                } else if (expected < -1e-7) {
                    ++inside;
                    if (value >= 0) ++open;
                } else if (brute(p[0], p[1], p[2] - kNudge) < -kFlat && brute(p[0], p[1], p[2] + kNudge) < -kFlat) {
                    // On the plane where one layer rests on another, with solid right above and below. (A flat top
                    // under the rounding of the next bead is no such place: there is a wedge of air, however thin.)
                    ++interfaces;
                    if (value >= 0) ++open;
                }
            }
        });
        EXPECT_EQ(wrong, 0U) << "of " << outside << " outside at " << voxel;
        EXPECT_EQ(open, 0U) << "of " << inside << " inside and " << interfaces << " on interfaces at " << voxel;
        EXPECT_GT(outside, 20000U);
        EXPECT_GT(inside, 20000U);
        RecordProperty("interfaces", static_cast<int>(interfaces));
        std::printf("  %s at %g mm: %zu active, %zu outside, %zu inside, %zu on interfaces\n", print.name, voxel,
                    static_cast<std::size_t>(grid->activeVoxelCount()), outside.load(), inside.load(),
                    interfaces.load());
    }
}

}  // namespace
}  // namespace stratum::voxelize
