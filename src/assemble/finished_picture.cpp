#include "assemble/finished_picture.h"

#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>

namespace stratum::assemble {

bool chooseDenoising(const Denoising& denoising, shade::RenderOptions& render) {
    const bool denoise =
        denoising.asked.value_or(!denoising.linear && render.spp > 1 && shade::canDenoise(render.integrator));
    if (!denoise) return false;
    if (!denoising.spp_given && !(render.noise > 0.0 || render.seconds > 0.0)) {
        // 8 are enough where a layer line is some pixels high. In a small picture several lines share a pixel, which
        // needs more samples; the total stays near that of the default size.
        constexpr int kLeast = 8, kMost = 32;
        constexpr std::int64_t kTotal = std::int64_t{1280} * 960 * kLeast * 11 / 10;
        const std::int64_t pixels = std::int64_t{render.width} * render.height;
        render.spp = kLeast;
        while (render.spp < kMost && pixels * render.spp * 2 <= kTotal) render.spp *= 2;
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
