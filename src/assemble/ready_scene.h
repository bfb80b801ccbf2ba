// The entrance for programs that want a picture: from files to a scene that shade::render() takes.
//
//     assemble::PictureOptions options;
//     const assemble::ReadyScene ready = assemble::readyScene("part.gcode", options);
//     const shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, options.render);
//     shade::PictureFile("part.png").write(result.film, {}, ready.tone);
#pragma once

#include "assemble/traced_objects.h"
#include "shade/camera/camera.h"
#include "shade/camera/pixel_size.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"

#include <glm/vec3.hpp>

#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

/// What a scene around objects depends on, besides the objects. The defaults make a product photo: studio light, a bed,
/// a camera that sees the whole part, and the material that the file states, or the default.
struct StageOptions {
    shade::SceneOptions scene;    ///< mm_per_unit, brdf and frame are replaced by what the objects say
    shade::RenderOptions render;  ///< the size of the picture, and whether its integrator needs light
    bool frame_all = false;       ///< fit a named view to all that is printed, not to the part
    bool find_exposure = true;    ///< fill in Stage::exposure
};

struct Stage {
    shade::SceneDescription scene;
    glm::dvec3 middle{0.0};          ///< world space, of what the camera is fitted to: the axis of turntables
    std::optional<double> exposure;  ///< stops, see shade::automaticExposure(); empty where the light needs none
};

/// Adds light, a bed and a camera to objects. Reports the step "preparing" to `events`. Throws UsageError.
Stage makeStage(const TracedObjects& objects, const StageOptions& options, const ReadEvents& events = {});

/// The sizes of pixels on a print, for PrintRequest::pixel_spread, which is called while the print is read. World space
/// is that of the print, mm.
/// @param outline  PrintLevels::outline
/// @param camera  of the picture, if it is known already; else null, and it follows from the boxes
/// @param turns   pictures of a turntable
shade::PixelSpread pixelSpreadOf(const StageOptions& options, const voxelize::Bounds& print,
                                 const voxelize::Bounds& part, std::span<const glm::dvec3> outline,
                                 const shade::Camera* camera = nullptr, int turns = 1);

/// All inputs of a picture except the files.
struct PictureOptions : StageOptions {
    /// The method, bricks, prints and events of `tracing` are used; material, colours, normals and labels follow from
    /// `scene` and `render`.
    TracingOptions tracing;
};

struct ReadyScene {
    TracedObjects objects;
    shade::SceneDescription scene;  ///< for shade::render() with objects.intersector
    shade::ToneOptions tone;        ///< exposure found from the light
    glm::dvec3 middle{0.0};         ///< see Stage::middle
};

/// Reads objects and makes a scene of them. Runs on the threads that TBB may use. Throws InputError for files that
/// can't be traced, UsageError for invalid options, with the option of the command line in the text.
ReadyScene readyScene(const std::vector<ObjectOptions>& objects, const PictureOptions& options);
/// The same of one file: G-code in any container, or a .vdb with a level set.
ReadyScene readyScene(const std::string& path, const PictureOptions& options = {});

}  // namespace stratum::assemble
