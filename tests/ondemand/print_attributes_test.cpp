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

TEST(PrintAttribute, RefusesNamesThatPrintsDontHave) {
    EXPECT_THROW((void)attributeNamed("temperature"), UsageError);
    EXPECT_THROW((void)attributeNamed("layer,tool"), UsageError);
    EXPECT_THROW((void)attributeNamed(""), UsageError);
}

}  // namespace
}  // namespace stratum::ondemand
