#include "report/level_set/outside.h"

#include "reported_print.h"
#include "voxelize/grid/solid_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::report {
namespace {

using std::numbers::pi;
using test::addArc;
using test::addBead;
using test::allBeads;
using test::layeredLattice;
using test::numberOf;
using test::reportOfAll;

constexpr double kWidth = 0.6;
constexpr double kHeight = 0.2;
constexpr double kSpacing = kWidth - kHeight * (1 - pi / 4);

// A disc of rings that close to a slab, down to the radius `inner` of their flats' middle.
void addRings(gcode::Toolpath& toolpath, double outer, int rings, int layer) {
    for (int n = 0; n < rings; ++n)
        addArc(toolpath, 0, 0, outer - n * kSpacing, 0, 2 * pi, layer * kHeight, layer * kHeight, kWidth, kHeight,
               static_cast<std::uint32_t>(layer));
}

// A pot of settled rings, with lid: what is inside is a cylinder of known size, beside the rounding of its wall.
gcode::Toolpath pot(int layers, int lids) {
    gcode::Toolpath toolpath;
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    constexpr int kRings = 9;
    const double outer = 8 * kSpacing + kWidth / 3;  // so that the last ring covers the middle
    for (int layer = 1; layer <= layers; ++layer)
        addRings(toolpath, outer, layer <= lids || layer > layers - lids ? kRings : 2, layer);
    return toolpath;
}

// Air between two rings' outer walls: a cylinder less the half stadiums that stick into it.
double hollowOf(int layers) {
    const double middle =
        7 * kSpacing + kWidth / 3 - kWidth / 2 + kHeight / 2;  // of the corners of the inner wall's side
    double area = 0;
    constexpr int kSteps = 2000;
    for (int n = 0; n < kSteps; ++n) {
        const double z = kHeight * ((n + 0.5) / kSteps - 0.5);
        const double radius = middle - std::sqrt(kHeight * kHeight / 4 - z * z);
        area += pi * radius * radius / kSteps;
    }
    return area * layers * kHeight;
}

TEST(Outside, PorosityOfAClosedPot) {
    const gcode::Toolpath path = pot(20, 3);
    const PrintReport report = reportOfAll(path, layeredLattice(kHeight, 4));
    // Rings of one layer close; those above one another leave nothing open.
    const double hollow = hollowOf(14);
    const double enclosed = numberOf(report, "plastic_volume") + hollow;
    EXPECT_NEAR(numberOf(report, "porosity"), 100 * hollow / enclosed, 0.5);
    EXPECT_NEAR(numberOf(report, "closed_porosity") + numberOf(report, "open_porosity"), numberOf(report, "porosity"),
                1e-4);
    EXPECT_NEAR(numberOf(report, "enclosed_volume"), enclosed, 0.005 * enclosed);
    // By layer: the hollow ones, and the solid ones.
    const Column& porosity = *report.findColumn("porosity");
    ASSERT_TRUE(report.slabs_are_layers);
    ASSERT_EQ(porosity.values.size(), 20U);
    const double of_layer = hollowOf(1) / (hollowOf(1) + report.findColumn("plastic_volume")->values[9]);
    EXPECT_NEAR(porosity.values[9], 100 * of_layer, 0.5);
    EXPECT_LT(porosity.values[0], 0.5);
}

TEST(Outside, AnOpenPotHasNoPores) {
    gcode::Toolpath path = pot(20, 3);
    std::erase_if(path.beads, [&](const gcode::Bead& bead) { return path.runOf(bead).layer > 17; });
    path.layer_count = 17;
    const PrintReport report = reportOfAll(path, layeredLattice(kHeight, 4));
    EXPECT_LT(numberOf(report, "porosity"), 0.5);
}

// A hole of one voxel's width is no way in for the ball, but a way out for a pore.
TEST(Outside, AClosedPoreAndOneWithASlit) {
    for (const double gap : {0.0, 0.09}) {
        openvdb::FloatGrid grid(3);
        grid.setGridClass(openvdb::GRID_LEVEL_SET);
        // A box of 40 voxels, walls of 10, and a slit of `gap` voxels times ten through one wall.
        const auto box = [](double x, double y, double z, double half) {
            return std::max({std::abs(x), std::abs(y), std::abs(z)}) - half;
        };
        for (int x = -30; x <= 30; ++x)
            for (int y = -30; y <= 30; ++y)
                for (int z = -30; z <= 30; ++z) {
                    double v = std::max(box(x, y, z, 20.4), -box(x, y, z, 10.4));
                    if (x > 0 && gap > 0) v = std::max(v, 5 * gap - std::abs(y));
                    if (std::abs(v) < 3)
                        grid.tree().setValueOn({x, y, z}, static_cast<float>(v));
                    else
                        grid.tree().setValueOff({x, y, z}, v < 0 ? -3.0F : 3.0F);
                }
        const LeafMap map(grid);
        const Outside outside(map, 0.6, 1, 3);
        const auto at = [&](int x, int y, int z) {
            const LeafMap::Place place = map.positions().at(x >> 3, y >> 3, z >> 3);
            EXPECT_TRUE(place.leaf);
            return outside.at(place.index, x & 7, y & 7, z & 7);
        };
        EXPECT_EQ(at(0, 9, 0), gap > 0 ? Air::open : Air::closed);
        EXPECT_EQ(at(0, 22, 0), Air::outside);
    }
}

// The hull is the surface that culling keeps.
TEST(Outside, HullIsThatOfCulling) {
    const gcode::Toolpath path = pot(12, 3);
    const auto beads = allBeads(path);
    const voxelize::Lattice lattice = layeredLattice(kHeight, 4);
    voxelize::VoxelizeOptions cull;
    cull.interior = voxelize::Interior::cull;
    const double culled = voxelize::enclosedVolume(*voxelize::voxelize(path, beads, lattice, cull));
    EXPECT_NEAR(numberOf(reportOfAll(path, lattice), "enclosed_volume"), culled, 0.002 * culled);
}

}  // namespace
}  // namespace stratum::report
