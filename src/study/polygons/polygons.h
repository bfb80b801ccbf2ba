// Level sets and formulas compared with polygons and beads, on one machine.
//
// Prints: what do convert, build and render cost for beads as primitives, as prisms, and here as a level set? After
// A. Spilar, "Visualization of 3D printing via ray tracing" (CTU Prague, 2025). Shapes: when is marching faster than
// tracing polygons? After Roukema, "SDFs versus polygons" (2023).
#pragma once

#include "study/polygons/peer_tracers.h"
#include "study/report/page.h"
#include "study/report/result_table.h"
#include "study/study.h"

#include <memory>
#include <string>
#include <vector>

namespace stratum::study {

struct PolygonsOptions {
    std::vector<std::string> scenes;       ///< scene files of spheres, boxes and cylinders
    std::vector<std::string> prints;       ///< G-code files, or folders of them
    std::string environment;               ///< of the prints' pictures, see shade::makeEnvironment; empty: studio
    std::vector<std::string> integrators;  ///< of the prints' pictures: path, ao; empty: both
    int spp = 0;     ///< of the prints' path-traced pictures; 0: 32, or 4 if quick. Totals are told for 32
    int frames = 0;  ///< of each scene; 0: 10, or 2 if quick
};

/// polygons_scenes.csv, polygons_prints.csv and polygons.html. Peers that this program has not are named in the
/// findings, and rows that they left in an earlier run are kept. Throws InputError, UsageError, OutputError.
StudyReport studyPolygons(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common);

/// Its halves: each adds its table's rows and findings to `report`, and its part to `page`; the table is for
/// Page::runs().
std::unique_ptr<ResultTable> studyScenes(const PolygonsOptions& options, const PeerTracers& peers,
                                         const StudyOptions& common, Page& page, StudyReport& report);
std::unique_ptr<ResultTable> studyPrints(const PolygonsOptions& options, const PeerTracers& peers,
                                         const StudyOptions& common, Page& page, StudyReport& report);

}  // namespace stratum::study
