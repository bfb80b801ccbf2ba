// What stands in front of the camera besides the print: material, light, bed, backdrop.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/camera/camera.h"
#include "shade/environment/environment.h"
#include "shade/light/light.h"
#include "shade/scene/bed.h"
#include "shade/scene/material.h"
#include "trace/intersector.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// A scene in the words of the command line. The defaults make a product photo.
struct SceneOptions {
    std::string brdf;                 ///< --brdf, see makeBrdf; empty: nobody said
    std::string color_by;             ///< --color-by: an attribute of all level sets without a material of their own
    bool smooth_normals = false;      ///< --normals smooth: shade with Tracer::shadingNormal()
    std::string env = "studio";       ///< --env, see makeEnvironment
    double env_rotation = 0.0;        ///< --env-rotation, degrees counter-clockwise as seen from above
    double env_exposure = 0.0;        ///< --env-exposure, stops
    std::vector<std::string> lights;  ///< --light, see parseLight and parseAmbient; they add to the environment
    bool bed = true;                  ///< a sweep under the print
    BedSurface bed_surface = BedSurface::paper;  ///< --bed-surface
    double mm_per_unit = 1.0;                    ///< millimetres a world unit: beds have grains and lines of a size
    bool backdrop = true;                        ///< false: nothing behind the print, alpha 0 there
    CameraOptions camera;
    /// What a named view is fitted to, world space: the part without what is printed beside it. Empty: all there is.
    std::optional<trace::Box> frame;
};

/// The whole numbers that tell apart what was printed.
enum class Label { layer, tool, feature };
inline constexpr std::size_t kLabels = 3;
/// Throws UsageError if the text is none of "layer", "tool", "feature".
Label parseLabel(std::string_view text);
std::string_view labelName(Label label);

/// A scene ready to be rendered. Everything is immutable and shared by all threads.
struct SceneDescription {
    Camera camera;
    std::shared_ptr<const Brdf> material;  ///< of all objects but `objects`; never null
    std::vector<ObjectMaterial> objects;   ///< by trace::Hit::object; may be shorter than there are objects
    bool smooth_normals = false;           ///< shade with Tracer::shadingNormal()
    /// By Label: the number of that attribute (Tracer::attribute()), if surfaces are to know it.
    std::array<std::optional<std::size_t>, kLabels> labels;
    std::shared_ptr<const Environment> environment;  ///< never null
    std::vector<std::shared_ptr<const Light>> lights;
    Color ambient{0.0f};  ///< radiance that reaches every point from everywhere
    std::optional<Bed> bed;
    std::optional<Backdrop>
        backdrop;  ///< what the camera sees behind everything; without it, a visible environment or nothing
};

/// Builds the scene around a print. The bed lies where the print's lowest surface is (found with a few thousand rays:
/// the narrow band's box reaches lower than the surface); a camera that is below the bed sees no bed.
/// @param width, height  pixels of the whole frame
/// Throws UsageError.
SceneDescription makeScene(const SceneOptions& options, const trace::Intersector& print, int width, int height);

/// Height of the print's lowest surface: print.bounds() is the box of the narrow band, which reaches lower. Found with
/// rays that look up; bounds().min.z if none meets anything. World units.
double restingHeight(const trace::Intersector& print);

}  // namespace stratum::shade
