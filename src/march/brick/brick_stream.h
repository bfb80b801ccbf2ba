// Many rays through bricks at once: the walk of brick_walk.h in the lanes of vectors.
//
// AVX-512 (8 lanes) or AVX2 (4), chosen at run time by Highway. Every lane does the operations of the scalar walk in
// their order, in double precision and without fused multiply-add, so its answer has the bits of the scalar one,
// whatever its neighbours, the order of the rays or the vector length.
#pragma once

#include "trace/intersector.h"

#include <span>

namespace stratum::march {

class BrickGrid;
struct CellMap;

/// As Tracer::intersectStream(). Returns false, without tracing, on machines without wide enough vectors: there the
/// scalar walk is faster.
bool streamIntersect(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                     std::span<trace::Hit> hits);
/// As Tracer::occludedStream(); false as above.
bool streamOccluded(const BrickGrid& grid, const CellMap& map, std::span<const trace::Ray> rays,
                    std::span<std::uint8_t> blocked);

}  // namespace stratum::march
