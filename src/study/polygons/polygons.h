// The halves of `vdbstudy polygons`: prints and shapes.
//
// Prints: what do convert, build and render cost for beads as primitives, as prisms, and here as a level set? After
// A. Spilar, "Visualization of 3D printing via ray tracing" (CTU Prague, 2025). Shapes: when is marching faster than
// tracing polygons? After Roukema, "SDFs versus polygons" (2023).
#pragma once

#include "study/polygons/peer_tracers.h"
#include "study/report/page.h"

namespace stratum::study {

/// Each adds its findings to `report`, and its part to `page`.
Table studyScenes(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common, Page& page,
                  StudyReport& report);
Table studyPrints(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common, Page& page,
                  StudyReport& report);

}  // namespace stratum::study
