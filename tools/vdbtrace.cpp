// vdbtrace: level set -> picture.
#include "command_line.h"
#include "trace_frame.h"
#include "trace_objects.h"
#include "trace_options.h"

#include "io/error.h"
#include "shade/brdf_file.h"
#include "shade/denoise.h"
#include "shade/exposure.h"
#include "shade/picture.h"
#include "shade/pixel_size.h"
#include "voxelize/voxel_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void run(tools::TraceCommand& o, int argc, char** argv) {
    tools::readScene(o, argc, argv);
    if ((o.render.noise > 0.0 || o.render.seconds > 0.0) && !o.spp_given) o.render.spp = 4096;
    tools::applyText(o);
    if (o.march != "auto" && o.march != "brick") tools::useHugePages(argv);  // bricks have their own
    const tools::ThreadLimit limit(o.common.threads);
    if (o.output.empty()) o.output = fs::path(o.inputs.front()).filename().replace_extension(".png").string();
    const bool linear = shade::PictureFile(o.output).linear();  // a bad name fails before the work
    if (!o.render.aovs.empty() && !linear)
        throw UsageError(fmt::format("--aov: layers need a picture that holds them; write an .exr, not {}", o.output));
    if (!o.render.checkpoint.empty() &&
        (o.prints.series > 1 || o.inputs.size() * static_cast<std::size_t>(o.turntable) > 1))
        throw UsageError("--checkpoint is for one picture; render the frames of a series one by one");
    if (!o.prints.brick_picture.empty() && !o.prints.brick_picture.ends_with(".png"))
        throw UsageError(fmt::format("--brick-picture {}: expected a .png", o.prints.brick_picture));
    // A picture to look at is clean; numbers to measure are unbiased.
    if (!o.denoise) o.denoise = !linear && o.render.spp > 1 && shade::canDenoise(o.render.integrator);
    if (*o.denoise) {
        constexpr int kEnough = 8;  // what a denoised picture needs
        if (!o.spp_given && !(o.render.noise > 0.0 || o.render.seconds > 0.0)) o.render.spp = kEnough;
        shade::addDenoisingGuides(o.render);
    }
    for (const std::string& note : o.notes) tools::say(o.common, note);

    tools::TraceOptions reading{.march = o.march,
                                .values = o.values,
                                .brdf = o.scene.brdf,
                                .color_by = o.scene.color_by,
                                .smooth_normals = o.scene.smooth_normals,
                                .labels = shade::labelsOf(o.render.aovs),
                                .prints = o.prints};
    reading.prints.quiet = o.common.quiet;
    if (!o.prints.brick_cache.empty()) {
        if (o.march != "auto" && o.march != "brick")
            throw UsageError(fmt::format("--brick-cache: --march {} has no bricks", o.march));
        reading.brick_cache = static_cast<std::size_t>(std::min(voxelize::parseSize(o.prints.brick_cache), 1e18));
    }
    if (const std::string& name = o.render.integrator.name; name == "layer" || name == "tool" || name == "feature") {
        const shade::Label label = shade::parseLabel(name);
        if (std::find(reading.labels.begin(), reading.labels.end(), label) == reading.labels.end())
            reading.labels.push_back(label);
    }
    const auto turns = static_cast<std::size_t>(o.turntable);
    std::optional<shade::SceneDescription> scene;
    reading.prints.pixel_spread = [&](const voxelize::Bounds& print) {
        if (!o.objects.empty()) throw UsageError("--voxel-size auto is of a print that stands alone; give a number");
        const march::Box box{{print.min[0], print.min[1], print.min[2]}, {print.max[0], print.max[1], print.max[2]}};
        const shade::Camera camera =
            scene ? scene->camera : shade::Camera::make(o.scene.camera, box, o.render.width, o.render.height);
        return shade::pixelSpread(camera, box, o.turntable);
    };
    glm::dvec3 middle(0.0);
    Json reports = Json::array();
    // From the last, which is the whole print and gives the camera, the bed and the light to all.
    for (std::size_t n = o.inputs.size(); n-- > 0;) {
        std::vector<shade::ObjectOptions> wanted = o.objects;
        if (wanted.empty()) {
            wanted.emplace_back();
            wanted.back().vdb = o.inputs[n];
            wanted.back().grid = o.grid;
            wanted.back().up = o.file_up;
        }
        if (o.prints.series > 1 && o.inputs.size() * wanted.size() > 1)
            throw UsageError("--progress-series is of one print alone");
        const tools::TraceObjects objects = tools::readTraceObjects(wanted, reading);
        if (o.prints.series > 1 && !objects.showMoment)
            throw UsageError("--progress-series needs G-code: level sets don't know what was printed when");
        const std::size_t count = o.inputs.size() * objects.moments * turns;
        if (!o.prints.brick_picture.empty() && !objects.writeBrickPicture)
            throw UsageError("--brick-picture needs G-code: level sets have no bricks that rays could leave out");
        for (const std::string& line : objects.lines) tools::say(o.common, line);
        tools::Stopwatch watch;
        if (!scene) {
            shade::SceneOptions seen = o.scene;
            seen.mm_per_unit = objects.mm_per_unit;
            // What is not seen costs nothing.
            if (!shade::needsLight(o.render.integrator) && seen.env == "studio") seen.env = "constant:0,0,0";
            scene = shade::makeScene(seen, *objects.intersector, o.render.width, o.render.height);
            const march::Box box = objects.intersector->bounds();
            middle = 0.5 * (box.min + box.max);
            const bool studio = seen.env == "studio" && seen.lights.empty();  // bright enough as it is
            if (!linear && !o.exposure_given && !studio && shade::needsLight(o.render.integrator))
                o.tone.exposure = shade::automaticExposure(*scene, middle);
            for (const std::string& note : scene->material->notes()) tools::say(o.common, "  material: " + note);
            if (!o.write_brdf.empty()) shade::writeBrdfFile(o.write_brdf, *scene->material);
        }
        scene->objects = objects.materials;
        scene->labels = objects.labels;
        double before_seconds = watch.lap();
        // From the whole print down to its first part: what one picture has made, the next one mostly keeps.
        for (std::size_t moment = objects.moments; moment-- > 0;) {
            if (moment + 1 < objects.moments) {
                objects.showMoment(moment);
                before_seconds = watch.lap();
            }
            const bool first = moment + 1 == objects.moments;
            for (std::size_t turn = 0; turn < turns; ++turn) {
                shade::SceneDescription view = *scene;
                if (turn > 0)
                    view.camera =
                        scene->camera.turned(360.0 * static_cast<double>(turn) / static_cast<double>(turns), middle);
                reports.push_back(tools::renderFrame(
                    o,
                    {fs::path(o.inputs[n]).filename().string(),
                     tools::numbered(o.output, (n * objects.moments + moment) * turns + turn, count),
                     first ? objects.load_seconds : 0.0, (first ? objects.build_seconds : 0.0) + before_seconds},
                    objects, view, limit.threads()));
                watch.lap();
            }
        }
        if (!o.prints.brick_picture.empty() && n == 0) objects.writeBrickPicture(o.prints.brick_picture);
    }
    tools::writeStats(o.common, reports.size() == 1 ? reports.front() : reports);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Ray-traces an OpenVDB level set into a picture.", "vdbtrace");
    tools::TraceCommand command;
    tools::addTraceOptions(app, command);
    return tools::runTool(app, argc, argv, [&] { run(command, argc, argv); });
}
