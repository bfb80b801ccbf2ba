// Tests of code in vectors: once for each instruction set that Highway may choose.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <string>

namespace stratum::test {

/// The parameter is a target of Highway; where the machine lacks it, or the build leaves it out, the test is skipped by
/// name.
class OnEachTarget : public testing::TestWithParam<std::int64_t> {
protected:
    void SetUp() override {
        if ((hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS & GetParam()) == 0)
            GTEST_SKIP() << "this machine or this build has no " << hwy::TargetName(GetParam());
        hwy::SetSupportedTargetsForTest(GetParam());
    }
    void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

inline auto allTargets() {
#if HWY_ARCH_ARM_A64
    return testing::Values(HWY_NEON, HWY_EMU128);
#else
    return testing::Values(
#ifdef HWY_AVX10_2  // since Highway 1.2
        HWY_AVX10_2,
#endif
#ifdef HWY_AVX3_SPR  // since Highway 1.1
        HWY_AVX3_SPR, HWY_AVX3_ZEN4,
#endif
        HWY_AVX3_DL, HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_EMU128);
#endif
}

inline std::string targetName(const testing::TestParamInfo<std::int64_t>& target) {
    return hwy::TargetName(target.param);
}

}  // namespace stratum::test
