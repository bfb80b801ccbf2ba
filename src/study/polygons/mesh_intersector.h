// Polygons without any acceleration: every ray against every triangle.
#pragma once

#include "study/polygons/triangle_mesh.h"
#include "trace/intersector.h"

#include <memory>

namespace stratum::study {

/// The renderer of Roukema, "SDFs versus polygons" (2023), by T. Moeller and B. Trumbore, "Fast, Minimum Storage
/// Ray/Triangle Intersection" (JGT 2(1), 1997), back faces culled. In double: exact enough to hold others against.
std::unique_ptr<trace::Intersector> makeMeshIntersector(const TriangleMesh& mesh);

}  // namespace stratum::study
