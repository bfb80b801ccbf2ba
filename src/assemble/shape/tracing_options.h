// How level sets, prints and shapes are read and made ready for rays.
#pragma once

#include "assemble/file/read_events.h"
#include "assemble/print/print_levels.h"
#include "base/names.h"
#include "march/brick/brick_grid.h"
#include "march/brick/brick_layout.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"
#include "trace/clip_intersector.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace stratum::assemble {

/// Which intersector level sets get.
enum class MarchMethod {
    automatic,  ///< brick
    brick,      ///< exact; the only one that takes G-code
    sphere,     ///< sphere tracing
    vdb,        ///< OpenVDB's own
};
inline constexpr Names<MarchMethod, 4> kMarchMethods = {{{"auto", MarchMethod::automatic},
                                                         {"brick", MarchMethod::brick},
                                                         {"sphere", MarchMethod::sphere},
                                                         {"vdb", MarchMethod::vdb}}};

struct TracingOptions {
    MarchMethod march = MarchMethod::automatic;
    march::BrickValues values = march::BrickValues::Int16;  ///< of bricks
    /// Of objects that have no material of their own, see shade::makeBrdf(). Empty: their files' colors if
    /// `file_colors`, else the default.
    std::string brdf;
    bool file_colors = false;  ///< objects without a material of their own have the colors that their files state
    /// "#rrggbb" -> material that stated colors have instead of plain plastic, see toolColorsOf().
    std::map<std::string, std::string> finishes;
    std::string color_by;  ///< attribute that colors level sets and prints without a material of their own
    std::optional<std::array<double, 2>> color_range;  ///< values at the ends of its ramp; empty: least and most
    bool smooth_normals = false;                       ///< answer Tracer::shadingNormal() without the facets of voxels
    /// Bytes of samples at once, of each print and of each large level set.
    std::size_t brick_cache = march::BrickGrid::kNoBound;
    std::vector<shade::Label> labels;    ///< that hits have; every level set must provide them
    PrintRequest prints;                 ///< of G-code
    std::vector<trace::ClipPlane> clip;  ///< --clip, world space: what lies before all of these planes is left
    bool hash = false;                   ///< fill in TracedObjects::source
    ReadEvents events;
};

/// Whether the picture or one of its layers depends on materials.
bool showsMaterial(const shade::RenderOptions& render);

/// `options` with what follows from a picture: material, colors, normals and labels.
TracingOptions tracingFor(const shade::SceneOptions& scene, const shade::RenderOptions& render,
                          TracingOptions options = {});

}  // namespace stratum::assemble
