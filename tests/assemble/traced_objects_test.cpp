#include "assemble/traced_objects.h"

#include "assemble/shape/shape.h"
#include "base/error.h"
#include "belt_box.h"
#include "export/plan/level_set_plan.h"
#include "prints.h"
#include "scratch_folder.h"
#include "shade/map_files.h"
#include "trace/sdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
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

// The .vdb that gcode2vdb writes of it.
std::filesystem::path writeBelt(const std::filesystem::path& path, const std::string& program,
                                const TracingOptions& options) {
    openvdb::initialize();
    const gcode::Toolpath toolpath = gcode::readToolpath(program, "belt.gcode", options.prints.print.read);
    exporter::LevelSetChoices choices;
    choices.print = options.prints.print;
    const exporter::LevelSetPlan plan(toolpath, choices);
    const auto grid =
        voxelize::Voxelizer(toolpath, plan.selection(), plan.lattice(), plan.voxelizeOptions()).printAll();
    exporter::describe(*grid, plan.lattice(), plan.provenance("belt.gcode", "", plan.selection()));
    exporter::writeVdb({grid}, path);
    return path;
}

TEST(TracedObjects, APrintOnABeltLiesAsItsLevelSetDoes) {
    const test::ScratchFolder scratch;
    const test::BeltBox belt;
    std::ofstream(scratch / "belt.gcode") << belt.program();
    TracingOptions options;
    options.prints.print.lattice.voxel_size = 0.125;
    options.prints.print.read.belt_angle = belt.degrees;
    options.prints.outline = true;
    const TracedObjects lazy = readTracedObjects({test::objectOf(scratch / "belt.gcode")}, options);
    const TracedObjects whole =
        readTracedObjects({test::objectOf(writeBelt(scratch / "belt.vdb", belt.program(), options))}, options);
    ASSERT_TRUE(lazy.part && whole.part);
    EXPECT_EQ(lazy.part->min, whole.part->min);
    EXPECT_EQ(lazy.part->max, whole.part->max);
    EXPECT_EQ(lazy.outline, whole.outline);
    const auto box = belt.box();
    EXPECT_NEAR(lazy.part->max.z, box[5], 1e-4);
    const auto of_lazy = lazy.intersector->makeTracer();
    const auto of_whole = whole.intersector->makeTracer();
    int hits = 0;
    double sum = 0;
    for (int n = 0; n < 2000; ++n) {
        const auto share = [n](double step) { return std::fmod(0.5 + n * step, 1.0); };
        const glm::dvec3 to(glm::mix(box[0], box[3], share(0.618034)), glm::mix(box[1], box[4], share(0.754878)),
                            glm::mix(box[2], box[5], share(0.569840)));
        trace::Ray ray;
        ray.origin = {to.x - 7, to.y - 40 + 80 * share(0.3247), to.z + 30};
        ray.direction = glm::normalize(to - ray.origin);
        trace::Hit one;
        trace::Hit other;
        const bool hit = of_lazy->intersect(ray, one);
        ASSERT_EQ(hit, of_whole->intersect(ray, other)) << n;
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR(one.t, other.t, 1e-9);
        EXPECT_NEAR(glm::dot(one.normal, other.normal), 1, 1e-9);
        // And where the lines are in the world.
        const double off = belt.distance(one.position.x, one.position.y, one.position.z);
        EXPECT_NEAR(off, 0, 0.0625);  // half a voxel, in creases
        sum += std::abs(off);
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LT(sum / hits, 0.01);
    // A scene's transform comes after the tilt.
    ObjectOptions turned = test::objectOf(scratch / "belt.gcode");
    turned.placement = trace::Placement::of(glm::dvec3(2.0), {0, 0, 90}, {100, 0, 0});
    const TracedObjects moved = readTracedObjects({turned}, options);
    EXPECT_NEAR(moved.part->max.z, 2 * box[5], 1e-3);
    EXPECT_NEAR(moved.part->max.x, 100 - 2 * box[1], 1e-3);
    EXPECT_NEAR(moved.part->min.y, 2 * box[0], 1e-3);
}

TEST(TracedObjects, EveryMethodTracesTheSameSphere) {
    const test::ScratchFolder scratch;
    const ObjectOptions object = test::objectOf(test::writeSphere(scratch / "sphere.vdb"));
    for (const MarchMethod method :
         {MarchMethod::automatic, MarchMethod::brick, MarchMethod::sphere, MarchMethod::vdb}) {
        TracingOptions options;
        options.march = method;
        const TracedObjects objects = readTracedObjects({object}, options);
        SCOPED_TRACE(nameOf(assemble::kMarchMethods, method));
        EXPECT_EQ(objects.intersector->name(),
                  nameOf(assemble::kMarchMethods, marchesBricks(method) ? MarchMethod::brick : method));
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

// The feature of each place that a section at that height shows, seen from above; nothing where it is not known.
std::vector<std::optional<float>> featuresOfCut(const TracedObjects& objects, double z) {
    const trace::Box box = objects.part.value_or(objects.intersector->bounds());
    const auto tracer = objects.intersector->makeTracer();
    std::vector<std::optional<float>> seen;
    for (double x = box.min.x; x < box.max.x; x += 0.37)
        for (double y = box.min.y; y < box.max.y; y += 0.41) {
            trace::Ray ray;
            ray.origin = {x, y, box.max.z + 1};
            ray.direction = {0, 0, -1};
            trace::Hit hit;
            if (!tracer->intersect(ray, hit) || std::abs(hit.position.z - z) > 1e-9) continue;
            const auto value = tracer->attribute(hit, 0);
            seen.push_back(value ? std::optional(value->x) : std::nullopt);
        }
    return seen;
}

TEST(TracedObjects, ASectionHasTheColorsOfItsPlace) {
    TracingOptions options = test::coarseTracing();
    options.prints.print.lattice.voxel_size = 0.02;  // of a band of 0.06 mm
    options.color_by = "feature";
    options.clip = {{{0, 0, 1}, 0.5}};
    const TracedObjects objects = readTracedObjects({test::printOf("tile.gcode")}, options);
    const auto seen = featuresOfCut(objects, 0.5);
    EXPECT_GT(seen.size(), 100U);
    EXPECT_EQ(std::count(seen.begin(), seen.end(), std::nullopt), 0);
    EXPECT_TRUE(objects.warnings.empty());
}

TEST(TracedObjects, SaysWhatASectionOfALevelSetLacks) {
    const test::ScratchFolder scratch;
    const std::filesystem::path path = test::writeSphere(scratch / "sphere.vdb");
    openvdb::FloatGrid::Ptr surface = test::sphereGrid(2, {1, 2, 3}, 0.2F, 3);
    surface->setName("surface");
    const auto tools = openvdb::Int32Grid::create();
    tools->setName("tool");
    tools->setTransform(surface->transform().copy());
    for (auto it = surface->cbeginValueOn(); it; ++it) tools->tree().setValueOn(it.getCoord(), 1);
    openvdb::io::File(path.string()).write({surface, tools});
    TracingOptions options;
    options.color_by = "tool";
    EXPECT_TRUE(readTracedObjects({test::objectOf(path)}, options).warnings.empty());
    options.clip = {{{0, 0, 1}, 3}};
    const TracedObjects objects = readTracedObjects({test::objectOf(path), test::objectOf(path)}, options);
    ASSERT_EQ(objects.warnings.size(), 1U);
    EXPECT_EQ(objects.warnings[0].kind, Warning::Kind::color_by);
    EXPECT_NE(objects.warnings[0].text.find("where --clip cuts deeper, the cut is grey"), std::string::npos)
        << objects.warnings[0].text;
    trace::Ray ray;
    ray.origin = {1.01, 2.01, 9};
    ray.direction = {0, 0, -1};
    trace::Hit hit;
    const auto tracer = objects.intersector->makeTracer();
    ASSERT_TRUE(tracer->intersect(ray, hit));
    const shade::Color cut = objects.materials[0].of(tracer->attribute(hit, 0)).albedo;
    EXPECT_EQ(cut.r, cut.g);
    EXPECT_EQ(cut.r, cut.b);
}

TEST(TracedObjects, SaysWhatAFileDoesNotTellApart) {
    const test::ScratchFolder scratch;
    // Two layers without a comment.
    std::string plain = "M83\nG1 Z0.2 F600\n";
    for (int layer = 0; layer < 2; ++layer)
        plain += "G1 Z" + std::to_string(0.2 * (layer + 1)) +
                 "\nG1 X0 Y0 F3000\nG1 X20 Y0 E0.7 F1200\nG1 X20 Y20 E0.7\nG1 X0 Y20 E0.7\nG1 X0 Y0 E0.7\n";
    test::writeText(scratch / "plain.gcode", plain);
    for (const auto& [by, said] :
         {std::pair{"feature", "names no features"}, {"object", "names no objects"}, {"color", "states no colour"}}) {
        TracingOptions options = test::coarseTracing();
        options.color_by = by;
        const TracedObjects objects = readTracedObjects({test::objectOf(scratch / "plain.gcode")}, options);
        const bool told =
            std::any_of(objects.warnings.begin(), objects.warnings.end(), [words = said](const Warning& warning) {
                return warning.kind == Warning::Kind::color_by && warning.text.find(words) != std::string::npos;
            });
        EXPECT_TRUE(told) << by;
    }
    TracingOptions options = test::coarseTracing();
    options.color_by = "feature";
    for (const Warning& warning : readTracedObjects({test::printOf("tile.gcode")}, options).warnings)
        EXPECT_NE(warning.kind, Warning::Kind::color_by) << warning.text;
}

TEST(TracedObjects, ReportsTheMaterialsInUse) {
    const test::ScratchFolder scratch;
    ObjectOptions red = test::objectOf(test::writeSphere(scratch / "sphere.vdb"));
    red.material.brdf = "lambert:1,0,0";
    // The scene's material is that of the only object, not the unused default.
    const TracedObjects one = readTracedObjects({red}, {});
    EXPECT_EQ(one.brdf, "lambert:1,0,0");
    EXPECT_EQ(one.material_report["brdf"], "lambert:1,0,0");
    ObjectOptions other = red;
    other.material.brdf = "lambert:0,1,0";
    const TracedObjects two = readTracedObjects({red, other, red}, {});
    EXPECT_EQ(two.brdfs, (std::vector<std::string>{"lambert:1,0,0", "lambert:0,1,0"}));
    EXPECT_EQ(two.material_report["brdf"].size(), 2U);
    TracingOptions options;
    options.brdf = "lambert:0,0,1";
    ObjectOptions plain = red;
    plain.material.brdf.clear();
    EXPECT_EQ(readTracedObjects({plain}, options).material_report["brdf"], "lambert:0,0,1");
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
