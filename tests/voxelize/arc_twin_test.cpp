// One print twice: as its slicer cut it, and with arcs welded from its straight moves. The two level sets may differ by
// the welder's tolerance, no more.
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

struct Difference {
    double largest = 0;
    std::size_t voxels = 0;
    std::size_t above = 0;  // the tolerance

    void join(const Difference& other) {
        largest = std::max(largest, other.largest);
        voxels += other.voxels;
        above += other.above;
    }
};

// Outside the solid both grids hold true distances, so that surfaces no further apart than the tolerance give values no
// further apart. Inside a value is a bound only and counts as 0: what is inside of one print must be within the
// tolerance of the other. Values are compared at every active voxel of `a`, up to the end of the band.
Difference compare(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b, double tolerance) {
    std::vector<const openvdb::FloatTree::LeafNodeType*> leaves;
    a.tree().getNodes(leaves);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, leaves.size()), Difference{},
        [&](const auto& range, Difference sum) {
            const auto accessor = b.getConstAccessor();
            for (std::size_t n = range.begin(); n != range.end(); ++n)
                for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel) {
                    const double one = std::max(0.0, static_cast<double>(*voxel));
                    const double two = std::max(0.0, static_cast<double>(accessor.getValue(voxel.getCoord())));
                    const double difference = std::abs(one - two);
                    ++sum.voxels;
                    sum.largest = std::max(sum.largest, difference);
                    if (difference > tolerance) ++sum.above;
                }
            return sum;
        },
        [](Difference one, const Difference& two) {
            one.join(two);
            return one;
        });
}

TEST(ArcTwin, LevelSetsDifferByTheWeldersTolerance) {
    STRATUM_NEEDS_CORPUS(lines_path, "gcode/gcode-preview-benchy_slic3r.gcode");
    STRATUM_NEEDS_CORPUS(arcs_path, "gcode/gcode-preview-benchy_arcs.gcode");
    const InputFile lines_file(lines_path);
    const InputFile arcs_file(arcs_path);
    const gcode::Toolpath lines = gcode::readToolpath(lines_file.bytes(), "lines");
    const gcode::Toolpath arcs = gcode::readToolpath(arcs_file.bytes(), "arcs");
    EXPECT_GT(arcs.arcs.size(), 3000U);
    EXPECT_TRUE(lines.arcs.empty());
    EXPECT_NEAR(arcs.filament_mm, lines.filament_mm, 1e-6 * lines.filament_mm);
    EXPECT_EQ(arcs.layer_count, lines.layer_count);

    const auto line_beads = selectBeads(lines, {});
    LatticeRequest request;
    request.voxel_size = 0.1;
    const Lattice lattice = chooseLattice(lines, line_beads, boundsOf(lines, line_beads), request);
    const auto line_grid = voxelize(lines, line_beads, lattice);
    const auto arc_grid = voxelize(arcs, selectBeads(arcs, {}), lattice);
    constexpr double kTolerance = 0.05;  // mm; the "resolution" that ArcWelder wrote into the file
    for (const auto& [a, b] : {std::pair{line_grid, arc_grid}, std::pair{arc_grid, line_grid}}) {
        const Difference difference = compare(*a, *b, kTolerance);
        std::printf("  %zu voxels, largest %.4f mm, above %zu\n", difference.voxels, difference.largest,
                    difference.above);
        EXPECT_GT(difference.voxels, 10'000'000U);
        EXPECT_GT(difference.largest, 0.001);  // they are not one and the same
        EXPECT_EQ(difference.above, 0U) << "of " << difference.voxels << "; the largest is " << difference.largest;
    }
    EXPECT_NEAR(enclosedVolume(*arc_grid), enclosedVolume(*line_grid), 1e-3 * enclosedVolume(*line_grid));
}

}  // namespace
}  // namespace stratum::voxelize
