#include "assemble/shape/tracing_options.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <vector>

namespace stratum::assemble {
namespace {

TEST(TracingOptions, FollowFromThePicture) {
    shade::SceneOptions scene;
    shade::RenderOptions render;
    TracingOptions options = tracingFor(scene, render);
    EXPECT_TRUE(options.file_colors);
    EXPECT_TRUE(options.labels.empty());

    render.integrator.name = "layer";  // shows no material
    options = tracingFor(scene, render);
    EXPECT_FALSE(options.file_colors);
    EXPECT_EQ(options.labels, std::vector{shade::Label::layer});

    render.aovs = shade::parseAovs("albedo,layer");
    scene.smooth_normals = true;
    options = tracingFor(scene, render);
    EXPECT_TRUE(options.file_colors && options.smooth_normals);
    EXPECT_EQ(options.labels, std::vector{shade::Label::layer});

    scene.brdf = "lambert:1,1,1";
    options = tracingFor(scene, render);
    EXPECT_FALSE(options.file_colors);
    EXPECT_EQ(options.brdf, "lambert:1,1,1");
}

}  // namespace
}  // namespace stratum::assemble
