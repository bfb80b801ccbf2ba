#include "shade/camera/ray_streams.h"

#include <algorithm>
#include <array>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/camera/sampler_stream.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shade/camera/sobol_lanes-inl.h"

#ifndef STRATUM_SAMPLER_STREAM_TYPES
#define STRATUM_SAMPLER_STREAM_TYPES
namespace stratum::shade {
namespace {

constexpr std::size_t kBatch = 64;  // whole vectors on every target

struct alignas(64) SamplerBatch {
    std::array<std::uint32_t, kBatch> block, index, draw;  // on the way in
    std::array<std::uint32_t, kBatch> x, y;                // the draws' first 32 bits
};

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {
namespace {

void Draw(SamplerBatch& batch) {
    const U u;
    for (std::size_t n = 0; n < kBatch; n += hn::Lanes(u)) {
        const Draw2D drawn =
            draw2D(hn::Load(u, &batch.block[n]), hn::Load(u, &batch.index[n]), hn::Load(u, &batch.draw[n]));
        hn::Store(drawn.x, u, &batch.x[n]);
        hn::Store(drawn.y, u, &batch.y[n]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(Draw);
}  // namespace

void next2DStream(std::span<Sampler> samplers, std::span<const std::size_t> which, std::span<glm::vec2> draws) {
    SamplerBatch batch{};
    for (std::size_t first = 0; first < which.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, which.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            Sampler& sampler = samplers[which[first + n]];
            batch.block[n] = sampler.block();
            batch.index[n] = sampler.index();
            batch.draw[n] = sampler.draw();
            sampler.skip();
        }
        HWY_DYNAMIC_DISPATCH(Draw)(batch);
        for (std::size_t n = 0; n < count; ++n)
            draws[first + n] = {sobol::toFloat(batch.x[n]), sobol::toFloat(batch.y[n])};
    }
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
