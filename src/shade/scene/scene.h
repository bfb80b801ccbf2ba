// A scene around a print: material, lights, bed, backdrop, camera.
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

/// The options of a scene, as on the command line. The defaults make a product photo.
struct SceneOptions {
    std::string brdf;      ///< --brdf, see makeBrdf; empty: not given
    std::string color_by;  ///< --color-by: an attribute of all level sets without a material of their own
    std::optional<std::array<double, 2>> color_range;  ///< --color-range: values at the ends of its ramp
    bool smooth_normals = false;                       ///< --normals smooth: shade with Tracer::shadingNormal()
    std::string env = "studio";                        ///< --env, see makeEnvironment
    double env_rotation = 0.0;                         ///< --env-rotation, degrees counter-clockwise as seen from above
    double env_exposure = 0.0;                         ///< --env-exposure, stops
    std::vector<std::string> lights;   ///< --light, see parseLight and parseAmbient; they add to the environment
    bool bed = true;                   ///< a sweep under the print
    std::optional<double> bed_height;  ///< world units, where the bed lies; empty: restingHeight()
    BedSurface bed_surface = BedSurface::paper;  ///< --bed-surface
    double mm_per_unit = 1.0;                    ///< millimetres a world unit, for the texture of the bed
    bool backdrop = true;                        ///< false: nothing behind the print, alpha 0 there
    bool transparent = false;  ///< --background none: only the print, and its shadow on the bed, see ShadowCatcher
    CameraOptions camera;
    /// The box that a named view is fitted to, world space: the part without skirts and towers. Empty: everything.
    std::optional<trace::Box> frame;
    std::vector<glm::dvec3> outline;  ///< points around the part, closer than that box; may be empty
};

/// Integer attributes of what was printed.
enum class Label { layer, tool, feature };
inline constexpr std::size_t kLabels = 3;
/// Throws UsageError if the text is none of "layer", "tool", "feature".
Label parseLabel(std::string_view text);
std::string_view labelName(Label label);

/// What a bed is in a transparent picture: black, with alpha where the print keeps light from it.
///
/// Alpha of a point on the bed is Y(B - L) / Y(E rho / pi): B is the radiance of the point without the print, L with
/// it, both as PathIntegrator finds them by the same samples, so that alpha is exactly 0 where nothing is shaded; E is
/// the unoccluded irradiance there, rho the reflectance of the bed, Y luminance. L has the light that the print
/// reflects onto the bed. Over a bed of that brightness, the picture has the luminance of one with a bed.
struct ShadowCatcher {
    Color irradiance{0.0f};  ///< of the bare bed by all but the lights
    float bare = 0.0f;       ///< luminance of the bare bed below the middle of the print
};

/// A scene ready to be rendered. Everything is immutable and shared by all threads.
struct SceneDescription {
    Camera camera;
    std::shared_ptr<const Brdf> material;  ///< of objects that are not in `objects`; never null
    std::vector<ObjectMaterial> objects;   ///< by trace::Hit::object; may be shorter than there are objects
    bool smooth_normals = false;           ///< shade with Tracer::shadingNormal()
    /// By Label: the number of that attribute (Tracer::attribute()), if SurfacePoint::labels needs it.
    std::array<std::optional<std::size_t>, kLabels> labels;
    std::shared_ptr<const Environment> environment;  ///< never null
    std::vector<std::shared_ptr<const Light>> lights;
    Color ambient{0.0f};  ///< radiance that reaches every point from everywhere
    std::optional<Bed> bed;
    std::optional<Backdrop> backdrop;  ///< the background for the camera; without it, a visible environment or nothing
    bool transparent = false;          ///< the camera sees nothing behind the print
    std::optional<ShadowCatcher> catcher;  ///< of the bed in a transparent picture; only PathIntegrator has it
    double mm_per_unit = 1.0;              ///< millimetres a world unit, for what goes on inside of translucent solids

    /// Whether light goes through a material of it.
    bool anyTranslucent() const;
    /// Whether one of its materials is another one at other places.
    bool anyByPlace() const;
};

/// Builds the scene around a print. The bed is at restingHeight(); it is invisible to a camera below it. A transparent
/// scene has no backdrop; its bed is a shadow catcher.
/// @param width, height  pixels of the whole frame
/// Throws UsageError.
SceneDescription makeScene(const SceneOptions& options, const trace::Intersector& print, int width, int height);

/// Height of the print's lowest surface, world units. Found with upward rays, a thousand or some thousands, because
/// print.bounds() is the box of the narrow band, which reaches lower; bounds().min.z if no ray hits anything.
double restingHeight(const trace::Intersector& print);

}  // namespace stratum::shade
