// The rays that a renderer sends at a print.
#pragma once

#include "trace/intersector.h"

#include <cstddef>
#include <string>
#include <vector>

namespace stratum::bench {

struct RaySet {
    std::string name;
    std::vector<trace::Ray> rays;
    bool any = false;  ///< only whether there is a hit is asked
};

/// Primary rays of a picture of `side` x `side` pixels from an oblique view, in tiles of 32 x 32; then, from their hits
/// found by `exact`: one and eight cosine-distributed rays a hit, unlimited and of 5 mm, and mirror bounces. Secondary
/// rays leave by `offset` along the normal, far enough for the least exact of the peers.
std::vector<RaySet> makeRaySets(const trace::Intersector& exact, int side, double offset);

}  // namespace stratum::bench
