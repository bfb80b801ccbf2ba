#include "assemble/traced_objects.h"

#include "assemble/shape/shape.h"
#include "base/error.h"
#include "prints.h"
#include "scratch_folder.h"
#include "shade/map_files.h"
#include "trace/sdf.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum::assemble {
namespace {

TEST(TracedObjects, APrintAloneHasTheColorThatItsFileStates) {
    TracingOptions options = test::coarseTracing();
    options.file_colors = true;
    const TracedObjects objects = readTracedObjects({test::printOf("tile.gcode")}, options);
    EXPECT_EQ(objects.brdf, "#d8563b");
    EXPECT_EQ(objects.no_color_lookup, "the print has one colour");
    EXPECT_EQ(objects.material_report["colors"][0]["color"], "#d8563b");
    ASSERT_EQ(objects.reports.size(), 1U);
    EXPECT_EQ(objects.reports[0]["voxel_size_mm"], 0.2);
    EXPECT_GT(objects.reports[0]["selected_beads"], 1000);
    ASSERT_EQ(objects.lines.size(), 1U);
    EXPECT_NE(objects.lines[0].find("voxel 0.2 mm"), std::string::npos) << objects.lines[0];
    EXPECT_TRUE(objects.source.empty());
    EXPECT_EQ(objects.mm_per_unit, 1.0);
    ASSERT_TRUE(objects.part);
    const glm::dvec3 middle = 0.5 * (objects.part->min + objects.part->max);
    EXPECT_TRUE(test::hitsFromAbove(*objects.intersector, middle.x + 0.013, middle.y + 0.017));
    ASSERT_EQ(objects.prints.size(), 1U);
    EXPECT_EQ(growingPrint(objects), nullptr);
    const auto report = onDemandReport(objects);
    ASSERT_EQ(report.size(), 1U);
    EXPECT_GT(report[0]["bricks_made"], 0);
    EXPECT_GT(report[0]["bricks_listed"], report[0]["bricks_made"]);
}

TEST(TracedObjects, TwoStatedColorsAreAskedForAtEachPlace) {
    TracingOptions options = test::coarseTracing();
    options.prints.print.lattice.voxel_size = 0.3;
    options.file_colors = true;
    const TracedObjects objects = readTracedObjects({test::printOf("two_tone.gcode")}, options);
    ASSERT_EQ(objects.materials.size(), 1U);
    EXPECT_FALSE(objects.materials[0].single());
    ASSERT_EQ(objects.legends.size(), 1U);
    EXPECT_EQ(objects.legends[0].entries.size(), 2U);
    EXPECT_TRUE(objects.no_color_lookup.empty());
}

TEST(TracedObjects, LabelsAndAttributesHaveNumbers) {
    TracingOptions options = test::coarseTracing();
    options.labels = {shade::Label::tool, shade::Label::layer};
    options.color_by = "layer";
    const TracedObjects objects = readTracedObjects({test::printOf("tile.gcode")}, options);
    EXPECT_EQ(objects.labels[static_cast<std::size_t>(shade::Label::tool)], 0U);
    EXPECT_EQ(objects.labels[static_cast<std::size_t>(shade::Label::layer)], 1U);
    EXPECT_FALSE(objects.labels[static_cast<std::size_t>(shade::Label::feature)]);
    ASSERT_EQ(objects.materials.size(), 1U);
    EXPECT_EQ(objects.materials[0].attribute(), 1U);
    ASSERT_EQ(objects.legends.size(), 1U);
    EXPECT_EQ(objects.legends[0].title, "layer");
}

TEST(TracedObjects, FilesAreReadOnceAndStandWhereTheyArePut) {
    const test::ScratchFolder scratch;
    ObjectOptions here = test::objectOf(test::writeSphere(scratch / "sphere.vdb"));
    ObjectOptions there = here;
    there.placement = trace::Placement::of(glm::dvec3(1.0), glm::dvec3(0.0), {20, 0, 0});
    there.material.brdf = "lambert:1,0,0";
    ObjectOptions shape;
    shape.sdf = trace::sdfSphere({-20, 0, 0}, 3);
    TracingOptions options;
    options.file_colors = true;
    options.hash = true;
    const TracedObjects objects = readTracedObjects({here, there, shape}, options);
    EXPECT_EQ(objects.reports.size(), 3U);
    EXPECT_EQ(objects.reports[0], objects.reports[1]);
    EXPECT_EQ(objects.reports[2]["sdf"], true);
    EXPECT_EQ(objects.lines.size(), 2U);  // the file's is told once
    EXPECT_EQ(objects.materials.size(), 3U);
    EXPECT_EQ(objects.mm_per_unit, 10.0);
    EXPECT_FALSE(objects.source.empty());
    EXPECT_FALSE(objects.part);  // no file knows its part
    EXPECT_TRUE(objects.prints.empty());
    EXPECT_TRUE(test::hitsFromAbove(*objects.intersector, 1.01, 2.01));
    EXPECT_TRUE(test::hitsFromAbove(*objects.intersector, 21.01, 2.01));
    EXPECT_TRUE(test::hitsFromAbove(*objects.intersector, -20.01, 0.01));
    EXPECT_FALSE(test::hitsFromAbove(*objects.intersector, 10, 0));
}

TEST(TracedObjects, EveryMethodTracesTheSameSphere) {
    const test::ScratchFolder scratch;
    const ObjectOptions object = test::objectOf(test::writeSphere(scratch / "sphere.vdb"));
    for (const MarchMethod method :
         {MarchMethod::automatic, MarchMethod::brick, MarchMethod::sphere, MarchMethod::vdb}) {
        TracingOptions options;
        options.march = method;
        const TracedObjects objects = readTracedObjects({object}, options);
        SCOPED_TRACE(marchMethodName(method));
        EXPECT_EQ(objects.intersector->name(), marchMethodName(marchesBricks(method) ? MarchMethod::brick : method));
        EXPECT_TRUE(test::hitsFromAbove(*objects.intersector, 1.01, 2.01));
        EXPECT_FALSE(test::hitsFromAbove(*objects.intersector, 3.2, 2.01));
    }
}

TEST(TracedObjects, TellsOfItsStepsAndWarnings) {
    const test::ScratchFolder scratch;
    std::vector<std::string> told;
    double last = 0;
    TracingOptions options = test::coarseTracing();
    options.events.begin = [&](std::string_view step, bool measured) {
        told.push_back(std::string(step) + (measured ? " %" : ""));
    };
    options.events.fraction = [&](double done) { last = done; };
    options.events.end = [&] { told.emplace_back("end"); };
    options.events.warning = [&](const Warning&) { told.emplace_back("warning"); };
    const ObjectOptions thin = test::objectOf(test::writeSphere(scratch / "thin.vdb", 2.5F));
    const TracedObjects objects = readTracedObjects({thin, test::printOf("tile.gcode")}, options);
    ASSERT_GE(objects.warnings.size(), 1U);
    EXPECT_EQ(objects.warnings[0].kind, Warning::Kind::narrow_band);
    EXPECT_NE(objects.warnings[0].text.find("thin.vdb: the narrow band is 2.50 voxels"), std::string::npos);
    ASSERT_GE(told.size(), 7U);
    EXPECT_EQ(std::vector<std::string>(told.begin(), told.begin() + 7),
              (std::vector<std::string>{"loading", "end", "warning", "laying out", "end", "reading %", "end"}));
    EXPECT_GT(last, 0.0);
}

TEST(TracedObjects, RefusesWhatDoesNotFit) {
    const test::ScratchFolder scratch;
    EXPECT_THROW((void)readTracedObjects({}, {}), UsageError);
    EXPECT_THROW((void)readTracedObjects({test::objectOf(scratch / "missing.vdb")}, {}), InputError);
    test::writeText(scratch / "text.vdb", "no grid");
    EXPECT_THROW((void)readTracedObjects({test::objectOf(scratch / "text.vdb")}, {}), InputError);
    TracingOptions sphere;
    sphere.march = MarchMethod::sphere;
    EXPECT_THROW((void)readTracedObjects({test::printOf("tile.gcode")}, sphere), UsageError);
    TracingOptions unknown = test::coarseTracing();
    unknown.color_by = "taste";
    EXPECT_THROW((void)readTracedObjects({test::printOf("tile.gcode")}, unknown), UsageError);
    TracingOptions no_room = test::coarseTracing();
    no_room.brick_cache = 1;
    EXPECT_THROW((void)readTracedObjects({test::printOf("tile.gcode")}, no_room), UsageError);
}

}  // namespace
}  // namespace stratum::assemble
