#include "shade/integrator/integrator.h"

#include "base/error.h"
#include "shade/analytic_prints.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(MakeIntegrator, KnowsItsNames) {
    const auto none = test::nothing();
    const auto scene = shade::makeScene({}, none, 8, 8);
    for (const char* name : {"path", "direct", "ao", "normal", "depth"}) {
        shade::IntegratorOptions options;
        options.name = name;
        EXPECT_TRUE(shade::makeIntegrator(options, scene, none)) << name;
    }
    shade::IntegratorOptions options;
    options.name = "photon";
    EXPECT_THROW(shade::makeIntegrator(options, scene, none), UsageError);
    options = {};
    options.bounces = 0;
    EXPECT_THROW(options.validate(), UsageError);
    options = {};
    options.ao_distance = 0.0;
    EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace stratum
