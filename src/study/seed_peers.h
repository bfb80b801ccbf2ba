// Who polygons are traced with where marching is compared with them.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "study/triangle_mesh.h"
#include "trace/intersector.h"

#include <cstddef>
#include <functional>
#include <memory>

namespace stratum::study {

/// A peer ready for rays.
struct Traced {
    std::unique_ptr<trace::Intersector> intersector;
    std::size_t primitives = 0;
};

/// A ray tracer of polygons. Both functions are empty where there is none.
struct SeedPeers {
    std::function<Traced(const TriangleMesh&)> mesh;
    /// Beads as they are (`corners` 0) or prisms of that many corners; those longer than `split` widths are cut, unless
    /// it is 0.
    std::function<Traced(const gcode::Toolpath&, int corners, double split)> beads;
};

/// The peers of this program: tools/no_peers.cpp has none, bench/seed_peers.cpp has Embree. The library has neither, so
/// that nothing in it depends on Embree.
SeedPeers seedPeers();

}  // namespace stratum::study
