// vdbstudy itself has no ray tracer of polygons; bench_vdbstudy has.
#include "study/polygons/peer_tracers.h"

namespace stratum::study {

PeerTracers peerTracers() { return {}; }

}  // namespace stratum::study
