#include "study/picture/render_plan.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace stratum::study {
namespace {

TEST(RenderPlan, ComparesAllWithAReferenceThatIsThere) {
    for (const bool quick : {true, false}) {
        const RenderPlan plan = makePlan({}, quick);
        EXPECT_EQ(plan.per_layer, quick ? (std::vector<int>{1, 2}) : (std::vector<int>{1, 2, 4, 8}));
        EXPECT_EQ(plan.variants.front().name, "brick");
        EXPECT_EQ(plan.variants.front().reference, ofSize(plan.base));
        for (const Variant& v : plan.variants) EXPECT_EQ(plan.referenceNamed(v.reference).name, v.reference);
    }
}

TEST(RenderPlan, SortsVoxelSizesAndTakesTheMiddleOne) {
    const RenderPlan plan = makePlan({6, 2, 3}, true);
    EXPECT_EQ(plan.per_layer, (std::vector<int>{2, 3, 6}));
    EXPECT_EQ(plan.base, 3);
    EXPECT_EQ(plan.variantNamed("brick, 6 a layer").kind.per_layer, 6);
    EXPECT_THROW((void)plan.variantNamed("brick, 3 a layer"), UsageError);
}

}  // namespace
}  // namespace stratum::study
