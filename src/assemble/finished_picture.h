// What vdbtrace decides about a picture besides its scene: denoising, samples, and the facts that its file states.
// Shared by all that write the same picture.
#pragma once

#include "assemble/traced_objects.h"
#include "shade/film/picture.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"

#include <optional>
#include <string>

namespace stratum::assemble {

/// Whether the picture is denoised, and with how many samples: both are filled in where they are not given.
struct Denoising {
    std::optional<bool> asked;  ///< empty: a picture to look at is, linear values to measure are not
    bool linear = false;        ///< the file keeps linear values
    bool spp_given = false;     ///< RenderOptions::spp is what was asked for
};
/// Decides it and adds what the denoiser needs to `render`. Throws UsageError.
bool chooseDenoising(const Denoising& denoising, shade::RenderOptions& render);

/// The facts of a PNG or EXR file.
/// @param source  name of the input, without its folder
shade::Metadata metadataOf(const std::string& source, const shade::RenderOptions& render, const std::string& env,
                           const TracedObjects& objects, const shade::SceneDescription& scene,
                           const shade::RenderResult& result, bool denoised);
/// The entry that a tone-mapped picture of light has besides.
shade::Metadata::value_type exposureFact(const shade::ToneOptions& tone);

}  // namespace stratum::assemble
