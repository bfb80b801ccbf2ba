#include "assemble/finished_picture.h"

#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace stratum::assemble {

bool chooseDenoising(const Denoising& denoising, shade::RenderOptions& render) {
    const bool denoise =
        denoising.asked.value_or(!denoising.linear && render.spp > 1 && shade::canDenoise(render.integrator));
    if (!denoise) return false;
    if (!denoising.spp_given && !(render.noise > 0.0 || render.seconds > 0.0)) {
        // 8 are enough where a layer line is some pixels high. In a small picture several lines share a pixel, which
        // needs more samples for the same error: see docs/shading.md, "Denoising".
        constexpr double kLeast = 8, kMost = 32, kLarge = 1280 * 960;
        const double pixels = static_cast<double>(render.width) * static_cast<double>(render.height);
        render.spp = static_cast<int>(std::lround(std::clamp(kLeast + 2 * std::log2(kLarge / pixels), kLeast, kMost)));
    }
    shade::addDenoisingGuides(render);
    return true;
}

shade::Metadata metadataOf(const std::string& source, const shade::RenderOptions& render, const std::string& env,
                           const TracedObjects& objects, const shade::SceneDescription& scene,
                           const shade::RenderResult& result, bool denoised) {
    shade::Metadata metadata{{"Software", "vdbtrace " STRATUM_VERSION},
                             {"Source", source},
                             {"Integrator", render.integrator.name},
                             {"SamplesPerPixel", fmt::format("{:g}", result.mean_spp)},
                             {"Seed", std::to_string(render.seed)},
                             {"Brdf", objects.brdf},
                             {"Environment", env}};
    if (!scene.material->notes().empty())
        metadata.insert({"BrdfNotes", fmt::format("{}", fmt::join(scene.material->notes(), "; "))});
    if (denoised) metadata.insert({"Denoised", shade::kDenoiserLabel});
    if (render.seconds > 0.0)
        metadata.insert({"Time", fmt::format("{:g} s; the samples depend on the machine", render.seconds)});
    return metadata;
}

shade::Metadata::value_type exposureFact(const shade::ToneOptions& tone) {
    return {"Exposure", fmt::format("{:.3f} stops", tone.exposure)};
}

}  // namespace stratum::assemble
