// vdbstudy itself has no ray tracer of polygons; bench_vdbstudy has.
#include "study/seed_peers.h"

namespace stratum::study {

SeedPeers seedPeers() { return {}; }

}  // namespace stratum::study
