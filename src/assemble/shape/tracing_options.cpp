#include "assemble/shape/tracing_options.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace stratum::assemble {
namespace {

constexpr std::array<std::string_view, 4> kMarchMethods = {"auto", "brick", "sphere", "vdb"};  // in the enum's order

}  // namespace

MarchMethod parseMarchMethod(std::string_view text) {
    const auto found = std::find(kMarchMethods.begin(), kMarchMethods.end(), text);
    if (found == kMarchMethods.end())
        throw UsageError(fmt::format("--march {}: expected auto, brick, sphere or vdb", text));
    return static_cast<MarchMethod>(found - kMarchMethods.begin());
}

std::string_view marchMethodName(MarchMethod method) { return kMarchMethods[static_cast<std::size_t>(method)]; }

bool showsMaterial(const shade::RenderOptions& render) {
    return shade::needsLight(render.integrator) ||
           std::find(render.aovs.begin(), render.aovs.end(), shade::Aov::albedo) != render.aovs.end();
}

TracingOptions tracingFor(const shade::SceneOptions& scene, const shade::RenderOptions& render,
                          TracingOptions options) {
    // The default material has tables, which take longer to make than some pictures; nobody looks at it there.
    options.brdf = scene.brdf.empty() && !showsMaterial(render) ? "lambert:1,1,1" : scene.brdf;
    options.file_colors = scene.brdf.empty() && scene.color_by.empty() && showsMaterial(render);
    options.color_by = scene.color_by;
    options.color_range = scene.color_range;
    options.smooth_normals = scene.smooth_normals;
    options.labels = shade::labelsOf(render.aovs);
    options.prints.outline = !scene.camera.eye;
    if (const std::string& name = render.integrator.name; name == "layer" || name == "tool" || name == "feature") {
        const shade::Label label = shade::parseLabel(name);
        if (std::find(options.labels.begin(), options.labels.end(), label) == options.labels.end())
            options.labels.push_back(label);
    }
    return options;
}

}  // namespace stratum::assemble
