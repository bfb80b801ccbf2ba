// Makes the radiance cache of a picture: follows some of its paths to their ends.
#pragma once

#include "shade/integrator/radiance_cache.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <functional>
#include <memory>

namespace stratum::shade {

/// Null where the picture uses none: nothing is translucent, the integrator does not go inside, or
/// IntegratorOptions::exact_translucency. The paths are from the scene's camera and meet a translucent print first: at
/// least 1024, a sixteenth of the frame's samples up to 65536, a thirty-second of them up to 262144, and fewer where
/// the camera sees little of such prints. All parts of a frame have the same cache, and its bits are the same for any
/// number of threads.
/// @param check  called from time to time from the calling thread; what it throws ends the work
std::shared_ptr<const RadianceCache> makeRadianceCache(const SceneDescription& scene, const trace::Intersector& print,
                                                       const RenderOptions& options,
                                                       const std::function<void()>& check = {});

}  // namespace stratum::shade
