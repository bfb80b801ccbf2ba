// One print held in one way and rendered: what a row of polygons_prints.csv is made of.
#pragma once

#include "study/cost/times.h"
#include "study/polygons/peer_tracers.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::study {

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
    int width = 1280, height = 960, spp = 32;
    int noise_spp = 0;    ///< samples a pixel of the pictures whose noise and bias are told; 0: they are not
    bool volume = false;  ///< the volume enclosed, of level sets made whole
    bool series = false;  ///< time for four stages of the print
};

/// What the first picture takes once the print is read: convert, build, one sample a pixel. For a process of its own,
/// where nothing has been made yet.
Times firstLook(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot);

/// All cells from kExtruded on. For a process of its own, whose peak memory is told.
/// @param first_look  told as it is, if it was measured
/// @param picture  a small copy for the page; empty: none
std::vector<std::string> measurePrint(const std::string& path, const Representation& r, const PeerTracers& peers,
                                      const Shot& shot, const std::optional<Times>& first_look,
                                      const std::filesystem::path& picture);

}  // namespace stratum::study
