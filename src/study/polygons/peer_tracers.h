// Ray tracers of polygons and of beads, which marching is compared with.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "study/polygons/triangle_mesh.h"
#include "trace/intersector.h"

#include <cstddef>
#include <functional>
#include <memory>

namespace stratum::study {

/// A peer ready for rays.
struct Traced {
    std::shared_ptr<const trace::Intersector> intersector;
    std::size_t primitives = 0;
};

/// Both functions are empty where there is none.
struct PeerTracers {
    std::function<Traced(const TriangleMesh&)> mesh;
    /// Beads as they are (`corners` 0) or prisms of that many corners; those longer than `split` widths are cut, unless
    /// it is 0.
    std::function<Traced(const gcode::Toolpath&, int corners, double split)> beads;
};

/// The peers of this program: tools/no_peers.cpp has none, bench/peer_tracers.cpp has Embree. The library has neither,
/// so that nothing in it depends on Embree.
PeerTracers peerTracers();

}  // namespace stratum::study
