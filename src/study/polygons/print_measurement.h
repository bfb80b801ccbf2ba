// One print held in one way and rendered: what a row of polygons_prints.csv is made of.
#pragma once

#include "study/cost/times.h"
#include "study/polygons/peer_tracers.h"
#include "study/report/table.h"

#include <string>

namespace stratum::study {

inline constexpr int kComparedSamples = 32;  ///< a pixel: what totals, noise and bias are told for

/// A way to hold a print for rays.
struct Representation {
    std::string name;
    int per_layer = 0;  ///< of a level set, voxels a layer; 0: none
    int corners = 0;    ///< of prisms; 0: beads as they are
    double split = 0;
    bool on_demand = false;  ///< of a level set: bricks are made when rays come to them
};

/// How a picture is taken.
struct Shot {
    std::string integrator = "path";
    std::string light;  ///< see shade::makeEnvironment; empty where the integrator looks at none
    int width = 1280, height = 960, spp = kComparedSamples;
};

/// What the first picture takes once the print is read: convert, build, one sample a pixel. For a process of its own,
/// where nothing has been made yet.
Times firstLook(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot);

/// The cells from "extruded_cm3" on, then a small picture as jpegOf() makes it, empty but for level sets. For a process
/// of its own, whose peak memory is told.
Row measurePrint(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot,
                 const Times& first_look);

}  // namespace stratum::study
