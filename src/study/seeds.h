// The questions of the two theses that this project began with, asked again on one machine.
//
// A. Spilar, "Visualization of 3D printing via ray tracing" (CTU Prague, 2025): what do convert, build and render cost
// for beads as primitives, as prisms, and here as a level set? Roukema, "SDFs versus polygons" (2023): when is marching
// better than polygons?
#pragma once

#include "study/page.h"
#include "study/seed_peers.h"
#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

struct SeedsOptions {
    std::vector<std::string> scenes;       ///< scene files of spheres, boxes and cylinders
    std::vector<std::string> prints;       ///< G-code files, or folders of them
    std::string environment;               ///< of the prints' pictures, see shade::makeEnvironment; empty: studio
    std::vector<std::string> integrators;  ///< of the prints' pictures: path, ao; empty: both
    int spp = 0;     ///< of the prints' path-traced pictures; 0: 32, or 4 if quick. Totals are told for 32
    int frames = 0;  ///< of each scene; 0: 10, or 2 if quick
};

/// seeds_scenes.csv, seeds_prints.csv and seeds.html. Peers that this program has not are named in the findings, and
/// rows that they left in an earlier run are kept. Throws InputError, UsageError, OutputError.
StudyReport studySeeds(const SeedsOptions& options, const SeedPeers& peers, const StudyOptions& common);

/// Its halves: each adds its table's rows and findings to `report`, and its part to `page`.
void studySeedScenes(const SeedsOptions& options, const SeedPeers& peers, const StudyOptions& common, Page& page,
                     StudyReport& report);
void studySeedPrints(const SeedsOptions& options, const SeedPeers& peers, const StudyOptions& common, Page& page,
                     StudyReport& report);

}  // namespace stratum::study
