#include "assemble/shape/tracing_options.h"

#include <algorithm>

namespace stratum::assemble {

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
