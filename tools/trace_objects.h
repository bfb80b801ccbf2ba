// vdbtrace's input: level sets and shapes, read, laid out for rays and put together.
#pragma once

#include "trace_print.h"

#include "assemble/object_file.h"
#include "march/brick/brick_grid.h"
#include "march/brick/brick_layout.h"
#include "shade/scene/scene.h"
#include "trace/scene_intersector.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {

/// How to read them.
struct TraceOptions {
    std::string march = "auto";  ///< --march, of level sets
    march::BrickValues values = march::BrickValues::Int16;
    std::string brdf;          ///< --brdf, of objects that have none of their own; empty: nobody said
    bool file_colors = false;  ///< objects of which nobody says the material have the colours that their files state
    std::string color_by;      ///< --color-by, of level sets that have no material of their own
    bool smooth_normals = false;
    std::size_t brick_cache = march::BrickGrid::kNoBound;  ///< --brick-cache, bytes
    std::vector<shade::Label> labels;                      ///< that the picture shows; every level set must have them
    TracePrintOptions prints;                              ///< of G-code
};

struct TraceObjects {
    std::shared_ptr<const trace::Intersector> intersector;
    std::vector<shade::ObjectMaterial> materials;  ///< by trace::Hit::object; empty if all are of the scene's
    decltype(shade::SceneDescription::labels) labels;
    nlohmann::ordered_json reports;   ///< of each object, for --stats
    std::string brdf;                 ///< the scene's material, see TraceMaterials::brdf()
    nlohmann::ordered_json material;  ///< for --stats
    std::vector<shade::Legend> legends;
    std::string no_color_lookup;  ///< why hits don't look for a colour; empty if that is no matter
    /// World-space box of the parts without what is printed beside them, if a file knows it.
    std::optional<trace::Box> part;
    std::string source;  ///< what tells the files from others, for checkpoints
    /// How many pictures a growing print makes, and what brings it to one of them; see TracePrintOptions::series.
    std::size_t moments = 1;
    std::function<void(std::size_t)> showMoment;
    /// Of each print that is sampled where rays come: what that took, to be asked when they have come.
    std::function<nlohmann::ordered_json()> on_demand;
    /// Of the last print, when rays have come; see writeBrickPicture().
    std::function<void(const std::string&)> writeBrickPicture;
    std::vector<std::string> lines;  ///< of each, for people
    double mm_per_unit = 1.0;        ///< of world space, as the first object's file says
    double load_seconds = 0.0, build_seconds = 0.0;
};

/// Reads every file once, whatever the number of objects that stand for it. Throws InputError, UsageError.
TraceObjects readTraceObjects(const std::vector<assemble::ObjectOptions>& objects, const TraceOptions& options);

}  // namespace stratum::tools
