#include "march/attribute/attribute_grid.h"

#include "base/error.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "spheres.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace stratum::march {
namespace {

class AttributeGrid : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    // A ball whose upper half is tool 1, from z = 0 on; its voxels also know their x, and two colours.
    void SetUp() override {
        surface = test::sphereGrid(2, openvdb::Vec3f(0), 0.1F);
        surface->transform().postTranslate(openvdb::Vec3d(10, 0, 0));
        tool = openvdb::Int32Grid::create();
        number = openvdb::FloatGrid::create();
        color = openvdb::Vec3SGrid::create();
        for (auto it = surface->cbeginValueOn(); it; ++it) {
            const openvdb::Coord c = it.getCoord();
            const int which = c.z() >= 0 ? 1 : 0;
            tool->tree().setValue(c, which);
            number->tree().setValue(c, static_cast<float>(c.x()));
            color->tree().setValue(c, which != 0 ? openvdb::Vec3f(1, 0, 0) : openvdb::Vec3f(0, 0.5F, 1));
        }
        tool->setName("tool");
        tool->insertMeta("names", openvdb::StringMetadata("0 first, 1 second one"));
        number->setName("speed");
        color->setName("color");
        for (const openvdb::GridBase::Ptr& grid : std::vector<openvdb::GridBase::Ptr>{tool, number, color})
            grid->setTransform(surface->transform().copy());
    }

    std::filesystem::path write(const openvdb::GridCPtrVec& grids) {
        const auto path = folder / "a.vdb";
        openvdb::io::File(path.string()).write(grids);
        return path;
    }

    test::ScratchFolder folder;
    openvdb::FloatGrid::Ptr surface;
    openvdb::Int32Grid::Ptr tool;
    openvdb::FloatGrid::Ptr number;
    openvdb::Vec3SGrid::Ptr color;
};

TEST_F(AttributeGrid, TakesTheNearestActiveVoxel) {
    const auto lookup = makeAttributeLookup(*tool);
    EXPECT_EQ(lookup->at({12, 0, -0.04})->x, 1);  // nearest to the plane of z = 0
    EXPECT_EQ(lookup->at({12, 0, -0.06})->x, 0);
    EXPECT_EQ(lookup->at({12, 0, 0.3})->x, 1);
    EXPECT_FALSE(lookup->at({10, 0, 0}));  // deep inside nothing is known
    EXPECT_FALSE(lookup->at({99, 0, 0}));
    const auto numbers = makeAttributeLookup(*number);
    EXPECT_EQ(numbers->at({12.04, 0, 0})->x, 20);  // never a mixture of two
    EXPECT_EQ(numbers->at({12.06, 0, 0})->x, 21);
    EXPECT_EQ(*makeAttributeLookup(*color)->at({12, 0, 0.3}), glm::vec3(1, 0, 0));
}

TEST_F(AttributeGrid, IsSummarized) {
    const trace::AttributeSummary tools = summarize(*tool);
    EXPECT_EQ(tools.kind, trace::AttributeSummary::Kind::integer);
    EXPECT_EQ(tools.least, 0);
    EXPECT_EQ(tools.most, 1);
    EXPECT_EQ(tools.labels, (std::vector<std::string>{"first", "second one"}));
    const trace::AttributeSummary numbers = summarize(*number);
    EXPECT_EQ(numbers.kind, trace::AttributeSummary::Kind::number);
    EXPECT_EQ(numbers.least, -numbers.most);
    const trace::AttributeSummary colors = summarize(*color);
    ASSERT_EQ(colors.colors.size(), 2u);
    EXPECT_EQ(colors.colors[0], glm::vec3(0, 0.5F, 1));
}

TEST_F(AttributeGrid, CountsWhatIsNoNumber) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const trace::AttributeSummary before = summarize(*number);
    EXPECT_EQ(before.not_finite, 0u);
    number->tree().setValueOn(openvdb::Coord(0, 0, 0), kNan);
    number->tree().setValueOn(openvdb::Coord(0, 0, 1), std::numeric_limits<float>::infinity());
    color->tree().setValueOn(openvdb::Coord(0, 0, 0), openvdb::Vec3f(0, kNan, 0));
    const trace::AttributeSummary numbers = summarize(*number);
    EXPECT_EQ(numbers.not_finite, 2u);
    EXPECT_EQ(numbers.most, before.most);
    const trace::AttributeSummary colors = summarize(*color);
    EXPECT_EQ(colors.not_finite, 1u);
    EXPECT_EQ(colors.colors.size(), 2u);
}

TEST_F(AttributeGrid, RefusesWhatDoesNotFit) {
    const auto refusal = [&](const std::filesystem::path& path, const char* name) -> std::string {
        return test::messageOf<InputError>([&] { readAttributeGrid(path, name, *surface); }, "(none)");
    };
    const auto path = write({surface, tool, openvdb::GridBase::createGrid("Tree_bool_5_4_3")});
    EXPECT_EQ(refusal(path, "tool"), "(none)");
    EXPECT_NE(refusal(path, "layer").find("gcode2vdb --grids layer"), std::string::npos);
    EXPECT_NE(refusal(path, "layer").find("surface, tool"), std::string::npos) << refusal(path, "layer");
    tool->transform().postTranslate(openvdb::Vec3d(0.1, 0, 0));
    EXPECT_NE(refusal(write({surface, tool}), "tool").find("another lattice"), std::string::npos);
    const auto flags = openvdb::GridBase::createGrid("Tree_bool_5_4_3");
    flags->setName("flags");
    EXPECT_NE(refusal(write({surface, flags}), "flags").find("holds bool"), std::string::npos);
    // A type that this OpenVDB does not know stands beside the others.
    const auto other = write({surface, flags});
    std::string bytes = test::bytesOf(other);
    bytes.replace(bytes.find("Tree_bool"), 9, "Tree_wild");
    test::writeText(other, bytes);
    EXPECT_NE(refusal(other, "flags").find("holds Tree_wild_5_4_3"), std::string::npos) << refusal(other, "flags");
    EXPECT_NE(refusal("/nonexistent.vdb", "tool").find("can't be opened"), std::string::npos);
}

TEST_F(AttributeGrid, AnnotatesHits) {
    const std::shared_ptr<const trace::Intersector> plain = makeBrickIntersector(*surface);
    EXPECT_EQ(annotate(plain, {}).get(), plain.get());
    const auto shape = annotate(plain, {surface, {makeAttributeSource(tool), nullptr}});
    const auto tracer = shape->makeTracer();
    trace::Hit hit;
    ASSERT_TRUE(tracer->intersect({{20, 0.3, 0.77}, {-1, 0, 0}}, hit));
    EXPECT_EQ(tracer->attribute(hit, 0)->x, 1);
    EXPECT_FALSE(tracer->attribute(hit, 1));
    EXPECT_FALSE(tracer->attribute(hit, 2));
    EXPECT_NE(tracer->shadingNormal(hit), hit.normal);
    EXPECT_EQ(plain->makeTracer()->shadingNormal(hit), hit.normal);
    EXPECT_GT(shape->bytes(), plain->bytes());
}

}  // namespace
}  // namespace stratum::march
