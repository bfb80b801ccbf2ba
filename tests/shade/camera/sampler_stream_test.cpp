#include "shade/camera/ray_streams.h"

#include "on_each_target.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum {
namespace {

using shade::Sampler;

class SamplerStream : public test::OnEachTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, SamplerStream, test::allTargets(), test::targetName);

TEST_P(SamplerStream, DrawsWhatEachWouldDraw) {
    for (const std::size_t count : {1u, 63u, 64u, 1000u}) {
        std::vector<Sampler> samplers;
        for (std::size_t n = 0; n < count; ++n) {
            samplers.emplace_back(static_cast<std::uint32_t>(n % 3), 16);
            samplers.back().start(static_cast<int>(n * 7 % 1921), static_cast<int>(n * 131 % 1083),
                                  static_cast<std::uint32_t>(n % 16));
            for (std::size_t k = 0; k < n % 5; ++k) samplers.back().skip();  // they stand at draws of their own
        }
        std::vector<Sampler> alone = samplers;
        std::vector<std::size_t> which;
        for (std::size_t n = count; n-- > 0;)
            if (n % 4 != 1) which.push_back(n);
        std::vector<glm::vec2> draws(which.size());
        shade::next2DStream(samplers, which, draws);
        for (std::size_t n = 0; n < which.size(); ++n) {
            Sampler twin = alone[which[n]];
            ASSERT_EQ(draws[n], alone[which[n]].next2D()) << n;
            ASSERT_EQ(draws[n].x, twin.next1D()) << n;
        }
        for (std::size_t n = 0; n < count; ++n)
            ASSERT_EQ(samplers[n].next1D(), alone[n].next1D()) << "sampler " << n << " stands elsewhere";
    }
}

}  // namespace
}  // namespace stratum
