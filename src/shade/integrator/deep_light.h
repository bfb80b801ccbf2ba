// Makes the radiance cache of a picture: follows some of its paths to their ends.
#pragma once

#include "shade/integrator/radiance_cache.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace stratum::shade {

/// A radiance cache that is being made. What is done stays when the work is put off.
struct RadianceCacheWork {
    static constexpr std::size_t kBatch = 16;  ///< streams of paths whose vertices are kept until all of them are there

    std::shared_ptr<RadianceCache> cache;
    std::size_t streams = 0;  ///< that are in the cache
    std::array<std::vector<DeepVertex>, kBatch> vertices;
    std::array<std::optional<std::size_t>, kBatch> followed;  ///< paths of those that are done, but not in the cache
};

/// Null where the picture uses none: nothing is translucent, the integrator does not go inside, there is
/// ambient light, or IntegratorOptions::exact_translucency. The paths are from the scene's camera and meet a
/// translucent print first: at least 1024, a sixteenth of the frame's samples up to 65536, a thirty-second of them up
/// to 262144, and fewer where the camera sees little of such prints. All parts of a frame have the same cache, and its
/// bits are the same for any number of threads. With RenderOptions::seconds it takes no more than half of them.
/// @param check  called from time to time from any thread, never from two at once; what it throws ends the work, and
///     the next call with the same IntegratorOptions::cache_work goes on
std::shared_ptr<const RadianceCache> makeRadianceCache(const SceneDescription& scene, const trace::Intersector& print,
                                                       const RenderOptions& options,
                                                       const std::function<void()>& check = {});

}  // namespace stratum::shade
