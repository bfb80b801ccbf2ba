#include "shade/brdf/brdf_batch.h"

#include "shade/brdf/lambert.h"
#include "shade/brdf/plastic.h"
#include "shade/brdf_checks.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::BrdfBatch;
using shade::Color;

/// Materials in rows of one and of many.
class BrdfBatchTest : public testing::Test {
protected:
    const shade::Brdf& brdfOf(int n) const {
        if (n % 50 < 20) return plastic_;
        return n % 2 == 0 ? static_cast<const shade::Brdf&>(dark_) : bright_;
    }
    float uniform() { return uniform_(random_); }
    glm::vec3 direction() { return test::direction(2.0 * double(uniform()) - 1.0, 6.28 * double(uniform())); }

    const shade::Lambert dark_{Color(0.2f)};
    const shade::Lambert bright_{Color(0.9f)};
    const shade::Plastic plastic_{Color(0.1f, 0.5f, 0.3f), 0.2f};
    std::mt19937 random_{5};
    std::uniform_real_distribution<float> uniform_{0.0f, 1.0f};
};

TEST_F(BrdfBatchTest, IsEachBrdfOfItsOwn) {
    constexpr int kCount = 300;
    BrdfBatch batch;
    for (int again = 0; again < 2; ++again) {  // it is used again and again
        batch.clear();
        std::vector<glm::vec3> wo, wi;
        for (int n = 0; n < kCount; ++n) {
            wo.push_back(direction());
            wi.push_back(direction());
            batch.addPair(brdfOf(n), wo.back(), wi.back());
        }
        batch.eval();
        ASSERT_EQ(batch.values.size(), wo.size());
        for (int n = 0; n < kCount; ++n) {
            const auto k = std::size_t(n);
            EXPECT_EQ(batch.wi(k), wi[k]);
            EXPECT_EQ(batch.values[k], brdfOf(n).eval(wo[k], wi[k])) << n;
            EXPECT_EQ(batch.densities[k], brdfOf(n).pdf(wo[k], wi[k])) << n;
        }
    }
}

TEST_F(BrdfBatchTest, DrawsFromEachBrdf) {
    constexpr int kCount = 300;
    BrdfBatch batch;
    std::vector<glm::vec3> wo;
    std::vector<float> lobes;
    std::vector<glm::vec2> u;
    for (int n = 0; n < kCount; ++n) {
        wo.push_back(direction());
        lobes.push_back(uniform());
        u.emplace_back(uniform(), uniform());
        batch.addDraw(brdfOf(n), wo.back(), lobes.back(), u.back());
    }
    batch.sample();
    int drawn = 0;
    for (int n = 0; n < kCount; ++n) {
        const auto k = std::size_t(n);
        const auto alone = brdfOf(n).sample(wo[k], lobes[k], u[k]);
        ASSERT_EQ(batch.samples[k].pdf, alone ? alone->pdf : 0.0f) << n;
        if (!alone) continue;
        ++drawn;
        EXPECT_EQ(batch.samples[k].wi, alone->wi);
        EXPECT_EQ(batch.samples[k].f, alone->f);
    }
    EXPECT_GT(drawn, kCount / 4);
    EXPECT_LT(drawn, kCount);  // some are below the surface
}

}  // namespace
}  // namespace stratum
