#include "shade/brdf.h"

#include "io/error.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::makeBrdf;

TEST(MakeBrdf, ReadsPresets) {
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    EXPECT_NEAR(makeBrdf("lambert:0.1,0.5,1")->eval(up, up).g, 0.5f / 3.14159265f, 1e-6f);
    EXPECT_GT(makeBrdf("plastic:0,0,0,0.1")->eval(up, up).r, 0.1f);
    EXPECT_TRUE(makeBrdf(shade::kDefaultBrdf));
}

TEST(MakeBrdf, RefusesNonsense) {
    for (const char* text : {"", "lambert", "lambert:", "lambert:1,2", "lambert:0.1,0.2,1.5", "lambert:0.1,0.2,-0.1",
                             "lambert:a,b,c", "lambert:0.1,0.2,nan", "lambert:0.1,0.2,0.3,", "plastic:0.1,0.2,0.3",
                             "plastic:0.1,0.2,0.3,0", "plastic:0.1,0.2,0.3,2", "chrome:1,1,1"})
        EXPECT_THROW(makeBrdf(text), UsageError) << text;
}

}  // namespace
}  // namespace stratum
