#include "ondemand/print_attributes.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

namespace stratum::ondemand {
namespace {

using voxelize::Attribute;

// Whether one of the eight voxels around a place is deeper inside than the narrow band.
bool reachesInside(const openvdb::FloatGrid& surface, const openvdb::Vec3d& place) {
    const openvdb::Coord cell = openvdb::Coord::floor(surface.worldToIndex(place));
    for (int c = 0; c < 8; ++c) {
        const openvdb::Coord voxel = cell.offsetBy(c >> 2, c >> 1 & 1, c & 1);
        float value = 0;
        if (!surface.tree().probeValue(voxel, value) && value < 0) return true;
    }
    return false;
}

TEST(PrintAttribute, SaysWhatTheGridSays) {
    openvdb::initialize();
    constexpr std::array kAll{Attribute::layer,  Attribute::time,  Attribute::feature, Attribute::tool,
                              Attribute::object, Attribute::width, Attribute::speed,   Attribute::color};
    const auto path = test::dataDir() / "gcode" / "gear.gcode";
    const InputFile file(path);
    const auto toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "gear"));
    const auto selection = voxelize::selectBeads(*toolpath, {});
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {std::nullopt, 2});
    voxelize::Voxelizer voxelizer(*toolpath, selection, lattice);
    const auto surface = voxelizer.printAll();
    const auto grids = voxelizer.attributes(kAll);
    const auto field = std::make_shared<const PrintField>(toolpath, selection, lattice, voxelize::Placement(), "gear");
    for (std::size_t n = 0; n < kAll.size(); ++n) {
        SCOPED_TRACE(voxelize::attributeName(kAll[n]));
        EXPECT_EQ(attributeNamed(voxelize::attributeName(kAll[n])), kAll[n]);
        const auto eager = march::makeAttributeLookup(*grids[n]);
        const auto source = makePrintAttribute(field, kAll[n]);
        const auto lazy = source->makeLookup();
        // Points in and around the narrow band, in no order.
        std::mt19937 random(7);
        std::uniform_real_distribution<double> near(-2, 2);
        std::set<float> values;
        std::size_t nothing = 0;
        std::size_t count = 0;
        for (auto it = surface->cbeginValueOn(); it; ++it) {
            if (++count % 2999 != 0) continue;
            const openvdb::Vec3d p = surface->indexToWorld(it.getCoord().asVec3d() +
                                                           openvdb::Vec3d(near(random), near(random), near(random)));
            const auto a = eager->at({p[0], p[1], p[2]});
            const auto b = lazy->at({p[0], p[1], p[2]});
            if (reachesInside(*surface, p)) {
                ASSERT_TRUE(b) << p;
                continue;
            }
            ASSERT_EQ(a.has_value(), b.has_value()) << p;
            nothing += a ? 0 : 1;
            if (!a) continue;
            ASSERT_EQ(*a, *b) << p;
            values.insert(a->x);
        }
        EXPECT_GT(nothing, 0U);
        const bool varies = kAll[n] != Attribute::tool && kAll[n] != Attribute::object && kAll[n] != Attribute::color;
        if (varies) {
            EXPECT_GT(values.size(), 3U);
        }
        const trace::AttributeSummary seen = march::summarize(*grids[n]);
        const trace::AttributeSummary known = summarize(*field, kAll[n], selection);
        EXPECT_EQ(known.kind, seen.kind);
        EXPECT_EQ(known.labels, seen.labels);
        EXPECT_EQ(known.colors, seen.colors);
        EXPECT_LE(known.least, seen.least);
        EXPECT_GE(known.most, seen.most);
    }
}

// A section shows places that are deeper than the band. There, a band as wide as a bead has the answers.
TEST(PrintAttribute, KnowsTheInsideBeyondTheBand) {
    openvdb::initialize();
    constexpr std::array kTime{Attribute::time};
    const auto path = test::dataDir() / "gcode" / "tile.gcode";
    const InputFile file(path);
    const auto toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "tile"));
    voxelize::Selection some;
    some.first_layer = 2;
    some.last_layer = 3;
    const auto selection = voxelize::selectBeads(*toolpath, some);
    voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {0.025, std::nullopt});
    const auto field = std::make_shared<const PrintField>(toolpath, selection, lattice, voxelize::Placement(), "tile");
    lattice.half_width = 9;
    voxelize::Voxelizer voxelizer(*toolpath, selection, lattice);
    const auto surface = voxelizer.printAll();
    const auto grids = voxelizer.attributes(kTime);
    const auto wide = march::makeAttributeLookup(*grids.front());
    const auto source = makePrintAttribute(field, Attribute::time);
    const auto lazy = source->makeLookup();
    std::size_t deep = 0;
    std::size_t count = 0;
    for (auto it = surface->cbeginValueOn(); it; ++it) {
        if (*it > -3.5F * 0.025F || ++count % 997 != 0) continue;
        ++deep;
        const openvdb::Vec3d p = surface->indexToWorld(it.getCoord().asVec3d() + openvdb::Vec3d(0.1, -0.2, 0.05));
        const auto here = lazy->at({p[0], p[1], p[2]});
        ASSERT_TRUE(here) << p;
        ASSERT_EQ(*here, *wide->at({p[0], p[1], p[2]})) << p;
    }
    EXPECT_GT(deep, 100U);
}

TEST(PrintAttribute, RefusesNamesThatPrintsDontHave) {
    EXPECT_THROW((void)attributeNamed("humidity"), UsageError);
    EXPECT_THROW((void)attributeNamed("layer,tool"), UsageError);
    EXPECT_THROW((void)attributeNamed(""), UsageError);
}

}  // namespace
}  // namespace stratum::ondemand
