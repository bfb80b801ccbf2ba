// Embree as a peer: on the mesh of a level set, and on beads, analytic or tessellated.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "march_peer.h"

#include <openvdb/openvdb.h>

#include <memory>

namespace stratum::bench {

/// Quads of volumeToMesh at adaptivity 0.
std::unique_ptr<Peer> embreeMesh(const openvdb::FloatGrid& grid);
/// User geometry: level straight beads as plan capsules swept by a ball. Beads longer than `split` widths are cut; 0
/// leaves them whole.
std::unique_ptr<Peer> embreeBeads(const gcode::Toolpath& toolpath, double split);
/// Embree's own curves, whole beads: their sections are no stadiums, so only their rates compare.
std::unique_ptr<Peer> embreeRound(const gcode::Toolpath& toolpath);
std::unique_ptr<Peer> embreeRibbons(const gcode::Toolpath& toolpath);
/// Quads around sections of `corners` vertices on the bead's outline.
std::unique_ptr<Peer> embreePrisms(const gcode::Toolpath& toolpath, int corners, double split);

}  // namespace stratum::bench
