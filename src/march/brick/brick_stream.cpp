#include "march/brick/brick_stream.h"

#include "march/brick/brick_walk.h"

#include <cstdint>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "march/brick/brick_stream.cpp"
#define HWY_WANT_AVX3_DL         // counts bits in vectors
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>
#include "march/brick/brick_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

bool intersectAll(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                  std::span<trace::Hit> hits) {
#if STRATUM_WIDE_LANES
    Marcher<false>(grid, map, rays, hits.data(), nullptr).run();
    return true;
#else
    (void)grid, (void)map, (void)rays, (void)hits;
    return false;
#endif
}

bool occludedAll(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                 std::span<std::uint8_t> blocked) {
#if STRATUM_WIDE_LANES
    for (std::uint8_t& flag : blocked) flag = 0;
    Marcher<true>(grid, map, rays, nullptr, blocked.data()).run();
    return true;
#else
    (void)grid, (void)map, (void)rays, (void)blocked;
    return false;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::march {

HWY_EXPORT(intersectAll);
HWY_EXPORT(occludedAll);

bool streamIntersect(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                     std::span<trace::Hit> hits) {
    // Here and not for each target: AVX-512 would scatter them, which is slower than storing one by one.
    for (trace::Hit& hit : hits) hit.t = std::numeric_limits<double>::infinity();
    return HWY_DYNAMIC_DISPATCH(intersectAll)(grid, map, rays, hits);
}

bool streamOccluded(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                    std::span<std::uint8_t> blocked) {
    return HWY_DYNAMIC_DISPATCH(occludedAll)(grid, map, rays, blocked);
}

}  // namespace stratum::march
#endif
