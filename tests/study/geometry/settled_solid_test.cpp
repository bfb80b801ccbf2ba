#include "study/geometry/settled_solid.h"

#include "corpus.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/geometry/union_field.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <utility>

namespace stratum::study {
namespace {

// Three layers of five lines at the spacing of the slicers.
gcode::Toolpath plate(double spacing) {
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 3; ++layer)
        for (int line = 0; line < 5; ++line)
            addBead(toolpath, 0, line * spacing, 0.2 * layer, 6, line * spacing, 0.2 * layer, 0.45, 0.2,
                    static_cast<std::uint32_t>(layer));
    return toolpath;
}
const double kSlicersSpacing = gcode::sectionArea(0.45, 0.2) / 0.2;

TEST(SettledSolid, IsTheUnionWhereNothingSettles) {
    const gcode::Toolpath toolpath = plate(0.41);
    const auto beads = allBeads(toolpath);
    const SettledSolid solid(toolpath, beads, 0.3);
    const UnionField exact(toolpath, beads, 0.3);
    EXPECT_EQ(solid.slope(), 1);
    int outside = 0;
    for (int n = 0; n < 20000; ++n) {
        const glm::dvec3 p(-0.5 + 7 * std::fmod(0.618033 * n, 1), -0.5 + 2.7 * std::fmod(0.414214 * n, 1),
                           -0.2 + std::fmod(0.732051 * n, 1));
        const double expected = exact.distance(p);
        if (expected <= 0) continue;
        ++outside;
        ASSERT_NEAR(solid.distance(p), expected, 1e-9) << n;
    }
    EXPECT_GT(outside, 3000);
}

TEST(SettledSolid, KeepsTheVolumeOfLinesSideBySide) {
    gcode::Toolpath toolpath = plate(kSlicersSpacing);
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    const auto beads = allBeads(toolpath);
    const SettledSolid solid(toolpath, beads, 0.3);
    // In the middle of the plate there is no gap: the layer is a slab.
    for (double y = 0.05; y < 4 * kSlicersSpacing; y += 0.013)
        for (double z = 0.01; z < 0.6; z += 0.017) EXPECT_LT(solid.distance({3, y, z}), 1e-9) << y << " " << z;
    const double area = solid.volume(1 << 16).value;
    // Five lines of 6 mm in three layers, and their round ends.
    const double lines = 15 * 6 * gcode::sectionArea(0.45, 0.2);
    EXPECT_GT(area, lines);
    EXPECT_LT(area, lines * 1.09);
}

// Layers 2 to 4, whose tops are open where the hull narrows.
gcode::Toolpath openTops(double crown, double corner_fraction) {
    gcode::Toolpath toolpath = readPrint((test::dataDir() / "gcode" / "hull.gcode").string());
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.crown = crown;
    toolpath.deposit.corner_fraction = corner_fraction;
    return toolpath;
}

TEST(SettledSolid, IsWhatTheVoxelizerMakes) {
    openvdb::initialize();
    for (const auto& [crown, corner_fraction] : {std::pair{0.0, 1.0}, std::pair{0.2, 1.0}, std::pair{0.3, 0.6}}) {
        const gcode::Toolpath toolpath = openTops(crown, corner_fraction);
        voxelize::Selection selection;
        voxelize::parseLayers("2:4", selection);
        std::vector<std::uint32_t> beads;
        for (const std::uint32_t bead : voxelize::selectBeads(toolpath, selection))
            if (toolpath.beads[bead].z0 == toolpath.beads[bead].z1) beads.push_back(bead);
        const SettledSolid solid(toolpath, beads, 0.3);
        const voxelize::Lattice lattice = latticeOf(toolpath, beads, 4);
        const auto grid = voxelize::voxelize(toolpath, beads, lattice);
        std::size_t seen = 0;
        std::size_t above = 0;  // the plane of the flats
        std::size_t number = 0;
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            if (number++ % 499 != 0) continue;
            const openvdb::Vec3d at = grid->indexToWorld(voxel.getCoord());
            const glm::dvec3 p(at[0], at[1], at[2]);
            const double expected = solid.distance(p);
            if (expected <= 1e-6 || expected > 0.1) continue;
            ++seen;
            above += p.z > 0.8 ? 1 : 0;
            EXPECT_NEAR(static_cast<double>(*voxel), expected, 2e-5) << crown;
            constexpr double kStep = 1e-5;  // mm
            glm::dvec3 slope;
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 step(0);
                step[axis] = kStep;
                slope[axis] = (solid.distance(p + step) - solid.distance(p - step)) / (2 * kStep);
            }
            EXPECT_LT(glm::length(slope), solid.slope()) << crown;
        }
        EXPECT_GT(seen, 400U);
        EXPECT_GT(above, 100U);
    }
}

// As many by area everywhere: a single bead's flats, sides and ends have theirs.
TEST(SettledSolid, PointsAreEvenOverTheSurface) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 6, 0, 0.2, 0.6, 0.2);
    const auto beads = allBeads(toolpath);
    const SettledSolid solid(toolpath, beads, 0.3);
    const auto points = solid.samplePoints(20000);
    ASSERT_EQ(points.size(), 20000U);
    double on_top = 0;
    for (const auto& [position, normal] : points) {
        EXPECT_NEAR(solid.distance(position), 0, 1e-9);
        EXPECT_NEAR(glm::length(normal), 1, 1e-9);
        EXPECT_GT(solid.distance(position + 1e-3 * normal), 0);
        on_top += normal.z > 0.9999 ? 1 : 0;
    }
    // The flat is 6 x 0.4 and a disc of 0.2; all of it is that twice, the sides, and half a torus.
    const double pi = std::acos(-1.0);
    const double flat = 6 * 0.4 + pi * 0.2 * 0.2;
    const double round = 2 * pi * 0.1 * 6 + 2 * pi * pi * 0.2 * 0.1 + 4 * pi * 0.1 * 0.1;
    EXPECT_NEAR(on_top / 20000, flat / (2 * flat + round), 0.015);
    const auto again = solid.samplePoints(500);
    for (std::size_t n = 0; n < again.size(); ++n) EXPECT_EQ(again[n].position, points[n].position);
}

}  // namespace
}  // namespace stratum::study
