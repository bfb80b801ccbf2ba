#include "assemble/file/object_file.h"

#include "assemble/scene_file.h"
#include "base/error.h"
#include "corpus.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/finish/named_brdf.h"
#include "shade/integrator/render.h"
#include "shade/map_files.h"
#include "trace/sdf_intersector.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace stratum {
namespace {

assemble::SceneFile scene(const test::ScratchFolder& scratch, const std::string& objects) {
    test::writeText(scratch / "s.json", R"({"objects": [)" + objects + "]}");
    return assemble::readSceneFile(scratch / "s.json");
}

TEST(ObjectFile, ReadsEveryKey) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "red.bsdf", "x");
    const auto file = scene(scratch, R"(
      {"vdb": "a.vdb", "grid": "surface", "color_by": "layer", "color_range": [2, 9],
       "transform": {"scale": 2, "rotate": [90, 0, 0], "translate": [1, 2, 3]}},
      {"vdb": "b.vdb", "material": {"by": "tool", "0": "red.bsdf", "1": "pla-blue", "other": "lambert:1,1,1"}},
      {"sdf": {"sphere": {"radius": 2}}, "voxel_size": 0.1, "material": "pla-blue",
       "transform": {"scale": [1, 2, 3]}})");
    ASSERT_EQ(file.objects.size(), 3u);
    EXPECT_TRUE(file.print.empty());
    const auto& a = file.objects[0];
    EXPECT_EQ(a.vdb, (scratch / "a.vdb").string());
    EXPECT_EQ(a.grid, "surface");
    EXPECT_EQ(a.material.by, "layer");
    EXPECT_EQ(a.material.range, (std::array<double, 2>{2, 9}));
    EXPECT_EQ(a.placement.linear * glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 2));
    EXPECT_EQ(a.placement.offset, glm::dvec3(1, 2, 3));
    const auto& b = file.objects[1];
    EXPECT_EQ(b.material.by, "tool");
    EXPECT_EQ(b.material.each.at("0"), (scratch / "red.bsdf").string());
    EXPECT_EQ(b.material.each.at("1"), "pla-blue");
    EXPECT_EQ(b.material.brdf, "lambert:1,1,1");
    EXPECT_TRUE(b.placement.isIdentity());
    const auto& c = file.objects[2];
    EXPECT_EQ(c.voxel_size, 0.1);
    EXPECT_EQ(c.material.brdf, "pla-blue");
    EXPECT_EQ(c.sdf->distance({0, 0, 5}), 3);
    EXPECT_EQ(c.placement.linear * glm::dvec3(1, 1, 1), glm::dvec3(1, 2, 3));
}

TEST(ObjectFile, SaysWhatIsWrong) {
    const test::ScratchFolder scratch;
    const auto refused = [&](const char* objects, const char* words) {
        EXPECT_TRUE(test::refuses<InputError>(words, [&] { scene(scratch, objects); })) << objects;
    };
    refused("", "objects: expected a list of objects");
    refused("3", "objects[0]: expected an object");
    refused("{}", "objects[0]: expected either \"vdb\" or \"sdf\"");
    refused(R"({"vdb": "a.vdb", "sdf": {"sphere": {"radius": 1}}})", "either");
    refused(R"({"vdb": "a.vdb"}, {"vdb": "b.vdb", "materail": "x"})",
            "objects[1].materail: unknown key; did you mean 'material'");
    refused(R"({"vdb": "a.vdb", "transform": {"rotation": [0,0,0]}})",
            "objects[0].transform.rotation: unknown key; did you mean 'rotate'");
    refused(R"({"vdb": "a.vdb", "transform": {"scale": "big"}})", "objects[0].transform.scale: expected 3 numbers");
    refused(R"({"vdb": "a.vdb", "material": {"0": "x"}})", "objects[0].material.by");
    for (const char* material : {R"({"by": "tool"})", R"({"by": "tool", "other": "pla-blue"})"})
        refused((R"({"vdb": "a.vdb", "material": )" + std::string(material) + "}").c_str(),
                "objects[0].material: expected a material for a value of tool beside \"by\"");
    refused(R"({"sdf": {"sphere": {"radius": 1}}, "color_by": "tool"})", "an sdf has no attributes");
    refused(R"({"vdb": "a.vdb", "color_range": [1, 2]})", "an attribute beside it, in");
    refused(R"({"vdb": "a.vdb", "color_by": "speed", "color_range": [2, 2]})", "the lower one first");
    refused(R"({"sdf": {"spere": {"radius": 1}}})", "objects[0].sdf.spere: unknown key; did you mean 'sphere'");
    refused(R"({"sdf": {"sphere": {"radius": -1}}})", "a sphere's radius is -1");
    refused(R"({"sdf": {"sphere": {}}})", "objects[0].sdf.sphere.radius: expected a number");
    refused(R"({"sdf": {"union": [{"sphere": {"radius": 1}}, {"box": {"half": [1,1,1]}}]}})",
            "objects[0].sdf.union[1].box.half_extents");
    refused(R"({"sdf": {"repeat": {"of": {"sphere": {"radius": 1}}, "period": [1, 0, 0]}}})", "can't be repeated");
    refused(R"({"sdf": {"torus": {"radius": 1, "tube": 0.2, "axis": "w"}}})", "axis: expected x, y or z");
    refused(R"({"sdf": {"sphere": {"radius": 1}, "box": {"half_extents": [1,1,1]}}})", "one shape or operation");
    test::writeText(scratch / "s.json", R"({"print": "a.vdb", "objects": [{"vdb": "b.vdb"}]})");
    EXPECT_THROW(assemble::readSceneFile(scratch / "s.json"), InputError);
}

TEST(ObjectFile, ShapesWithinShapes) {
    const test::ScratchFolder scratch;
    const auto file = scene(scratch, R"({"sdf": {"subtraction": [
        {"box": {"half_extents": [2, 2, 2]}},
        {"move": {"rotate": [0, 90, 0], "translate": [0, 0, 1],
                  "of": {"cylinder": {"radius": 0.5, "half_height": 9}}}},
        {"repeat": {"period": [1, 1, 0], "count": 2, "of": {"sphere": {"center": [0, 0, -0.2], "radius": 0.3}}}},
        {"intersection": [{"plane": {"normal": [0, 0, 1], "offset": -1.5}}, {"torus": {"radius": 5, "tube": 1}}]}]}})");
    const auto& shape = *file.objects[0].sdf;
    EXPECT_LT(shape.distance({0, 0, -1.2}), 0);
    EXPECT_GT(shape.distance({1.7, 0, 1}), 0);  // the cylinder lies along x now
    EXPECT_LT(shape.distance({0, 1.7, 1}), 0);
    EXPECT_GT(shape.distance({1, 1, -0.2}), 0);  // a copy of the sphere
    std::string deep = R"({"sphere": {"radius": 1}})";
    for (int n = 0; n < 100; ++n) deep = R"({"union": [)" + deep + "]}";
    EXPECT_THROW(scene(scratch, R"({"sdf": )" + deep + "}"), InputError);
}

// The scenes of the second thesis, as the project has them: what the camera sees in the middle of some pixels is known.
TEST(ObjectFile, TheSevenScenesAreThere) {
    std::vector<std::size_t> counts;
    for (int n = 1; n <= 7; ++n) {
        const auto file =
            assemble::readSceneFile(test::dataDir() / "scenes" / ("roukema_" + std::to_string(n) + ".json"));
        counts.push_back(file.objects.size());
        std::vector<trace::SceneObject> objects;
        std::vector<shade::ObjectMaterial> materials;
        for (const auto& object : file.objects) {
            objects.push_back({trace::makeSdfIntersector(object.sdf, object.tolerance), object.placement});
            materials.emplace_back(shade::makeBrdf(object.material.brdf));
        }
        const auto scene_objects = trace::makeSceneIntersector(std::move(objects));
        auto scene = shade::makeScene(file.scene, *scene_objects, 50, 50);
        scene.objects = materials;
        shade::RenderOptions options = file.render;
        options.width = options.height = 50;
        options.spp = 4;
        const auto result = shade::render(*scene_objects, scene, options);
        const auto& film = result.film;
        // Something is seen, lit and coloured, and behind it is the background of 245.
        std::set<int> hues;
        int background = 0;
        for (const auto& pixel : film.pixels()) {
            ASSERT_TRUE(std::isfinite(pixel.rgb.r + pixel.rgb.g + pixel.rgb.b));
            if (std::abs(pixel.rgb.g - 0.913099f) < 1e-4f && std::abs(pixel.rgb.r - pixel.rgb.g) < 1e-5f)
                ++background;
            else
                hues.insert((pixel.rgb.r > 0.4f ? 4 : 0) + (pixel.rgb.g > 0.4f ? 2 : 0) + (pixel.rgb.b > 0.4f ? 1 : 0));
        }
        EXPECT_LT(background, 2500 - 100) << n;
        EXPECT_TRUE(n == 5 || background > 300) << n;
        EXPECT_TRUE(n != 6 || hues.size() >= 4u) << hues.size();
        if (n == 1) {
            // A sphere of radius 1 at distance 5: its outline is at tan(asin(1/5)) of a frame that is 1 wide.
            const double radius = 50 * std::tan(std::asin(0.2));
            EXPECT_NEAR(2500 - background, 3.14159 * radius * radius, 4 * radius);
        }
    }
    EXPECT_EQ(counts, (std::vector<std::size_t>{1, 1, 1, 2, 4, 25, 3}));
}

}  // namespace
}  // namespace stratum
