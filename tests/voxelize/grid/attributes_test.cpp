#include "voxelize/grid/attributes.h"

#include "base/error.h"
#include "refusal.h"
#include "toolpaths.h"
#include "voxelize/grid/interior_distance.h"
#include "voxelize/grid/voxel_choice.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

// Two stacked lines of different tools, a sloped one beside them, in a print that changes its filament.
gcode::Toolpath twoTone() {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 6, 0, 0.2, 0.5, 0.2, 1);
    addBead(toolpath, 0, 0, 0.4, 6, 0, 0.4, 0.5, 0.2, 2);
    addBead(toolpath, 0, 2, 0.2, 6, 2, 0.6, 0.5, 0.2, 3);
    toolpath.runs[0].speed = 30;
    toolpath.runs[0].feature = gcode::Feature::infill;
    for (std::uint32_t n = 1; n < 3; ++n) {
        toolpath.runs.push_back(toolpath.runs[0]);
        toolpath.runs.back().layer = n + 1;
        toolpath.runs.back().tool = static_cast<std::uint8_t>(n);
        toolpath.runs.back().speed = 60;
        toolpath.beads[n].run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
    }
    toolpath.tool_colors = {gcode::Rgb{255, 0, 0}, gcode::Rgb{0, 255, 0}};
    toolpath.color_changes = {{2, 2, {0, 0, 255}}};
    return toolpath;
}

TEST(Attributes, EveryVoxelNamesTheNearestBead) {
    const gcode::Toolpath toolpath = twoTone();
    Lattice lattice;
    lattice.voxel_size = 0.05;
    Voxelizer voxelizer(toolpath, allBeads(toolpath), lattice);
    const auto surface = voxelizer.printAll();
    const auto wanted = parseGrids("surface,layer,time,feature,tool,width,speed,color,layer");
    ASSERT_EQ(wanted.size(), 7U);
    const auto grids = voxelizer.attributes(wanted);
    const auto layer = openvdb::gridConstPtrCast<openvdb::Int32Grid>(grids[0])->getConstAccessor();
    const auto time = openvdb::gridConstPtrCast<openvdb::FloatGrid>(grids[1])->getConstAccessor();
    const auto color = openvdb::gridConstPtrCast<openvdb::Vec3SGrid>(grids[6])->getConstAccessor();
    std::vector<BeadField> fields;
    for (const gcode::Bead& bead : toolpath.beads) fields.emplace_back(toolpath, bead);
    std::size_t seen[3] = {};
    for (auto voxel = surface->cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Vec3d p = surface->indexToWorld(voxel.getCoord());
        const auto n = static_cast<std::size_t>(layer.getValue(voxel.getCoord()) - 1);
        ASSERT_LT(n, 3U);
        ++seen[n];
        for (const BeadField& other : fields)
            ASSERT_LE(fields[n].distance(p[0], p[1], p[2]), other.distance(p[0], p[1], p[2]) + 1e-6);
        ASSERT_NEAR(time.getValue(voxel.getCoord()), n == 0 ? 0 : n == 1 ? 0.2 : 0.3, 1e-6);
        ASSERT_EQ(color.getValue(voxel.getCoord()), openvdb::Vec3f(n == 0, n == 1, n == 2));
    }
    for (const std::size_t count : seen) EXPECT_GT(count, 1000U);
    for (const auto& grid : grids) {
        EXPECT_EQ(grid->activeVoxelCount(), surface->activeVoxelCount());
        EXPECT_EQ(grid->transform(), surface->transform());
    }
    EXPECT_EQ(grids[2]->getName(), "feature");
    EXPECT_NE(grids[2]->getMetadata<openvdb::StringMetadata>("names")->value().find("4 infill"), std::string::npos);
    EXPECT_EQ(
        openvdb::gridConstPtrCast<openvdb::FloatGrid>(grids[4])->getConstAccessor().getValue(openvdb::Coord(60, 0, 2)),
        0.5f);
}

// Above a raised top, too, whose band ends higher than that of its bead.
TEST(Attributes, RaisedTopsNameTheirBeads) {
    gcode::Toolpath toolpath;
    for (int n = 0; n < 24; ++n) addBead(toolpath, -4, 0.3 * n, 0.2, 4, 0.3 * n, 0.2, 0.45, 0.2, 1);
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.crown = 0.2;
    Lattice lattice;
    lattice.voxel_size = 0.025;
    Voxelizer voxelizer(toolpath, allBeads(toolpath), lattice);
    const auto surface = voxelizer.printAll();
    const auto grids = voxelizer.attributes(parseGrids("surface,layer"));
    const auto layer = openvdb::gridConstPtrCast<openvdb::Int32Grid>(grids[0])->getConstAccessor();
    std::size_t above = 0;  // the band of a top that is not raised
    for (auto voxel = surface->cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Vec3d p = surface->indexToWorld(voxel.getCoord());
        above += p[2] > 0.2 + lattice.background() ? 1 : 0;
        ASSERT_EQ(layer.getValue(voxel.getCoord()), 1) << p;
    }
    EXPECT_GT(above, 1000U);
}

TEST(Attributes, TimeAndSpeedAreThePlans) {
    gcode::Toolpath toolpath = twoTone();
    const std::vector<Attribute> wanted{Attribute::time, Attribute::speed};
    EXPECT_EQ(BeadAttributes(toolpath, wanted).number(Attribute::speed, 1), 60);
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n)
        toolpath.timing.push_back({.start = 10.0 * static_cast<double>(n + 1), .seconds = n == 2 ? 0.0f : 2.0f});
    const BeadAttributes values(toolpath, wanted);
    EXPECT_EQ(values.number(Attribute::time, 0), 10);
    EXPECT_EQ(values.number(Attribute::time, 2), 30);
    EXPECT_NEAR(values.number(Attribute::speed, 1), gcode::beadLength(toolpath, toolpath.beads[1]) / 2, 1e-5);
    EXPECT_EQ(values.number(Attribute::speed, 2), 60);  // one that takes no time
}

TEST(Attributes, UnitsAreThoseOfTheirGrids) {
    EXPECT_EQ(attributeUnit("speed"), "mm/s");
    EXPECT_EQ(attributeUnit("layer_time"), "s");
    EXPECT_EQ(attributeUnit("deviation"), "mm");
    EXPECT_EQ(attributeUnit("layer"), "");
    EXPECT_EQ(attributeUnit("of somebody else"), "");
}

TEST(Attributes, UnknownNamesAreListed) {
    EXPECT_TRUE(test::refuses<UsageError>("color", [&] { parseGrids("layer,colour"); }));
    EXPECT_TRUE(parseGrids("surface").empty());
}

TEST(InteriorDistance, IsADistanceInsideAndChangesNothingOutside) {
    // A thick bead, where the inside is known: the same formula as outside, negative.
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 4, 0, 0.2, 3, 0.2);
    addBead(toolpath, 0, 0, 0.4, 4, 0, 0.4, 3, 0.2);
    addBead(toolpath, 0, 0, 0.6, 4, 0, 0.6, 3, 0.2);
    Lattice lattice;
    lattice.voxel_size = 0.05;
    const auto plain = voxelize(toolpath, allBeads(toolpath), lattice);
    const auto swept = plain->deepCopy();
    sweepInterior(*swept);
    const auto before = plain->getConstAccessor();
    for (auto voxel = swept->cbeginValueOn(); voxel; ++voxel) {
        if (*voxel < 0) continue;
        ASSERT_EQ(*voxel, before.getValue(voxel.getCoord()));
    }
    const auto after = swept->getConstAccessor();
    // Far from the sides only the flats at 0 and 0.6 count.
    for (int k = 1; k < 12; ++k) {
        const double expected = std::max(-std::min(0.05 * k, 0.6 - 0.05 * k), -3 * 0.05);
        EXPECT_NEAR(after.getValue(openvdb::Coord(40, 0, k)), expected, 0.004) << k;
    }
    // The plain values are a bound there: shallower than the truth.
    EXPECT_GT(before.getValue(openvdb::Coord(40, 0, 4)), -0.12);
}

TEST(VoxelChoice, ToleranceGivesTheCoarsestThatKeepsIt) {
    EXPECT_EQ(voxelsPerLayerForTolerance(0.2, 0.1), kFewestVoxelsPerLayer);
    EXPECT_EQ(voxelsPerLayerForTolerance(0.2, 5), kFewestVoxelsPerLayer);
    EXPECT_EQ(voxelsPerLayerForTolerance(0.2, 0.075), 2);
    EXPECT_EQ(voxelsPerLayerForTolerance(0.2, 0.074), 3);
    EXPECT_THROW(voxelsPerLayerForTolerance(0.2, 1e-6), UsageError);
    EXPECT_THROW(voxelsPerLayerForTolerance(0.2, -1), UsageError);
    EXPECT_EQ(voxelsPerLayerForPixel(0.2, 5), kFewestForPixels);
    EXPECT_EQ(voxelsPerLayerForPixel(0.2, 0.1), 4);
    EXPECT_EQ(voxelsPerLayerForPixel(0.2, 0.099), 5);
    EXPECT_EQ(voxelsPerLayerForPixel(0.2, 1e-9), kMostForPixels);
    EXPECT_EQ(voxelsPerLayerForPixel(0.2, 0), kMostForPixels);
}

TEST(VoxelChoice, SizesAreReadAsPeopleWriteThem) {
    EXPECT_EQ(parseSize("4GB"), 4e9);
    EXPECT_EQ(parseSize("800 mb"), 8e8);
    EXPECT_EQ(parseSize("1.5g"), 1.5e9);
    EXPECT_EQ(parseSize("123"), 123);
    EXPECT_EQ(parseSize("4GiB"), 4.0 * 1024 * 1024 * 1024);
    EXPECT_EQ(parseSize("200 MiB"), 200.0 * 1024 * 1024);
    EXPECT_EQ(parseSize("1.5Ki"), 1536);
    EXPECT_EQ(parseSize("2TB"), 2e12);
    for (const char* bad : {"", "4iB", "4GiBB", "4PB", "GB", "-4GB", "4 apples", "nan"})
        EXPECT_THROW(parseSize(bad), UsageError) << bad;
}

TEST(VoxelChoice, TheBudgetIsKeptAndUsed) {
    gcode::Toolpath toolpath;
    for (int layer = 0; layer < 40; ++layer)
        for (int line = 0; line < 20; ++line)
            addBead(toolpath, 0, 0.4 * line, 0.2 * (layer + 1), 8, 0.4 * line, 0.2 * (layer + 1), 0.45, 0.2,
                    static_cast<std::uint32_t>(layer + 1));
    const auto beads = allBeads(toolpath);
    LatticeRequest request;
    request.voxels_per_layer = kFewestVoxelsPerLayer;
    Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
    for (const Interior interior : {Interior::keep, Interior::cull}) {
        for (const double budget : {8e6, 20e6, 60e6}) {
            const int count = voxelsPerLayerWithin(budget, toolpath, beads, lattice, interior);
            Lattice chosen = lattice;
            VoxelizeOptions options;
            options.interior = interior;
            chosen.voxel_size = lattice.layer_height / count;
            EXPECT_LE(static_cast<double>(voxelize(toolpath, beads, chosen, options)->memUsage()), budget);
            chosen.voxel_size = lattice.layer_height / (count + 1);
            EXPECT_GT(static_cast<double>(voxelize(toolpath, beads, chosen, options)->memUsage()), budget * 0.4);
        }
        EXPECT_THROW(voxelsPerLayerWithin(1e4, toolpath, beads, lattice, interior), UsageError);
    }
}

// Temperatures are of the bead's tool, and before a tool's own is set, the first one that it gets.
TEST(Attributes, ValuesThatTheProgramSets) {
    gcode::Toolpath toolpath = twoTone();
    const std::vector<Attribute> both = parseGrids("temperature,fan");
    EXPECT_THROW((void)BeadAttributes(toolpath, both), InputError);
    toolpath.temperatures = {{1, 0, 210}, {2, 2, 240}, {9, 1, 190}};
    toolpath.fans = {{2, 0, 50}};
    for (std::uint32_t n = 0; n < 3; ++n) toolpath.beads[n].arc = -static_cast<std::int32_t>(n + 1);
    const BeadAttributes values(toolpath, both);
    EXPECT_EQ(values.number(Attribute::temperature, 0), 210.0F);
    EXPECT_EQ(values.number(Attribute::temperature, 1), 190.0F);
    EXPECT_EQ(values.number(Attribute::temperature, 2), 240.0F);
    EXPECT_EQ(values.number(Attribute::fan, 0), 0.0F);
    EXPECT_EQ(values.number(Attribute::fan, 1), 50.0F);

    // An acceleration holds for all tools; what was printed before has the first one.
    const std::vector<Attribute> motion = parseGrids("acceleration,pressure_advance");
    EXPECT_THROW((void)BeadAttributes(toolpath, motion), InputError);
    toolpath.accelerations = {{2, 0, 800}, {3, 0, 2000}};
    toolpath.pressure_advances = {{1, 1, 0.25F}, {3, 0, 0.5F}};
    const BeadAttributes set(toolpath, motion);
    EXPECT_EQ(set.number(Attribute::acceleration, 0), 800.0F);
    EXPECT_EQ(set.number(Attribute::acceleration, 1), 800.0F);
    EXPECT_EQ(set.number(Attribute::acceleration, 2), 2000.0F);
    EXPECT_EQ(set.number(Attribute::pressure_advance, 0), 0.5F);
    EXPECT_EQ(set.number(Attribute::pressure_advance, 1), 0.25F);
    EXPECT_EQ(attributeUnit("acceleration"), "mm/s^2");
}

TEST(Attributes, HeightsOfBeads) {
    const gcode::Toolpath toolpath = twoTone();
    const std::vector<Attribute> wanted = parseGrids("height");
    const BeadAttributes values(toolpath, wanted);
    for (std::uint32_t bead = 0; bead < 3; ++bead)
        EXPECT_EQ(values.number(Attribute::height, bead), toolpath.runOf(toolpath.beads[bead]).height);
    EXPECT_GT(values.number(Attribute::height, 0), 0.0F);
    EXPECT_EQ(attributeUnit("height"), "mm");
}

TEST(Attributes, TimesOfLayers) {
    gcode::Toolpath toolpath = twoTone();
    toolpath.layer_count = 3;
    toolpath.timing = {{0, 2}, {3, 4}, {7, 1}};
    const std::vector<Attribute> wanted = parseGrids("layer_time");
    const BeadAttributes values(toolpath, wanted);
    EXPECT_EQ(values.number(Attribute::layer_time, 0), 2.0F);
    EXPECT_EQ(values.number(Attribute::layer_time, 1), 5.0F);
    EXPECT_EQ(values.number(Attribute::layer_time, 2), 1.0F);
}

}  // namespace
}  // namespace stratum::voxelize
