// Embree behind the interface of src/march, so that the same renderer makes the same picture with it.
#pragma once

#include "embree_scene.h"
#include "trace/intersector.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace stratum::bench {

/// Rays begin at the scene's box, so that Embree's floats count from there and not from the eye; streams go in packets
/// of 16. Normals are those of the primitives.
/// @param objects  by primitive: Hit::object; empty: 0
std::unique_ptr<trace::Intersector> embreeIntersector(std::unique_ptr<EmbreeScene> scene,
                                                      std::vector<std::uint32_t> objects = {});

}  // namespace stratum::bench
