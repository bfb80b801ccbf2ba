#include "trace_series.h"

#include "progress.h"
#include "trace_frame.h"
#include "trace_objects.h"

#include "base/error.h"
#include "shade/camera/pixel_size.h"
#include "shade/measured/brdf_file.h"
#include "shade/post/exposure.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

TraceOptions readingOf(const TraceCommand& o) {
    TraceOptions reading{.march = o.march,
                         .values = o.values,
                         .brdf = o.scene.brdf,
                         .file_colors = o.scene.brdf.empty() && o.scene.color_by.empty() && showsMaterial(o),
                         .color_by = o.scene.color_by,
                         .smooth_normals = o.scene.smooth_normals,
                         .labels = shade::labelsOf(o.render.aovs),
                         .prints = o.prints};
    reading.prints.quiet = o.common.quiet;
    reading.prints.hash = !o.render.checkpoint.empty();
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
    return reading;
}

class Series {
public:
    Series(const TraceCommand& o, int threads) : o_(o), threads_(threads), reading_(readingOf(o)) {
        reading_.prints.pixel_spread = [this](const voxelize::Bounds& print, const voxelize::Bounds& part) {
            return spread(print, part);
        };
    }

    /// Frames of one input, which all have the camera, the bed and the light of the first that is traced.
    void trace(std::size_t n) {
        std::vector<assemble::ObjectOptions> wanted = o_.objects;
        if (wanted.empty()) {
            wanted.emplace_back();
            wanted.back().vdb = o_.inputs[n];
            wanted.back().grid = o_.grid;
            wanted.back().up = o_.file_up;
        }
        const TraceObjects objects = readTraceObjects(wanted, reading_);
        if (o_.prints.series > 1 && !objects.showMoment)
            throw UsageError("--progress-series needs G-code: level sets don't know what was printed when");
        if (!o_.prints.brick_picture.empty() && !objects.writeBrickPicture)
            throw UsageError("--brick-picture needs G-code: level sets have no bricks that rays could leave out");
        for (const std::string& line : objects.lines) say(o_.common, line);
        if (o_.legend && objects.legends.empty()) say(o_.common, "  no legend: nothing is coloured by an attribute");
        Stopwatch watch;
        if (!scene_) begin(objects);
        if (!o_.render.checkpoint.empty()) o_.render.source = sourceOf(o_, objects.source);
        scene_->objects = objects.materials;
        scene_->labels = objects.labels;
        frames(n, objects, watch);
        if (!o_.prints.brick_picture.empty() && n == 0) objects.writeBrickPicture(o_.prints.brick_picture);
    }

    const Json& reports() const { return reports_; }

private:
    static trace::Box boxOf(const voxelize::Bounds& b) {
        return {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}};
    }

    shade::PixelSpread spread(const voxelize::Bounds& print, const voxelize::Bounds& part) const {
        if (!o_.objects.empty()) throw UsageError("--voxel-size auto is of a print that stands alone; give a number");
        const trace::Box box = boxOf(print);
        const shade::Camera camera = scene_
                                         ? scene_->camera
                                         : shade::Camera::make(o_.scene.camera, o_.frame == "all" ? box : boxOf(part),
                                                               o_.render.width, o_.render.height);
        return shade::pixelSpread(camera, box, o_.turntable);
    }

    void begin(const TraceObjects& objects) {
        shade::SceneOptions seen = o_.scene;
        seen.mm_per_unit = objects.mm_per_unit;
        seen.brdf = objects.brdf;
        if (o_.frame != "all") seen.frame = objects.part;
        // What is not seen costs nothing.
        if (!shade::needsLight(o_.render.integrator) && seen.env == "studio") seen.env = "constant:0,0,0";
        {
            const ProgressNote note("preparing", o_.common.quiet);
            scene_ = shade::makeScene(seen, *objects.intersector, o_.render.width, o_.render.height);
        }
        const trace::Box box = seen.frame.value_or(objects.intersector->bounds());
        middle_ = 0.5 * (box.min + box.max);
        const bool studio = seen.env == "studio" && seen.lights.empty();  // bright enough as it is
        if (!o_.linear && !o_.exposure_given && !studio && shade::needsLight(o_.render.integrator))
            o_.tone.exposure = shade::automaticExposure(*scene_, middle_);
        for (const std::string& note : scene_->material->notes()) say(o_.common, "  material: " + note);
        if (!o_.write_brdf.empty()) shade::writeBrdfFile(o_.write_brdf, *scene_->material);
    }

    void frames(std::size_t n, const TraceObjects& objects, Stopwatch& watch) {
        const auto turns = static_cast<std::size_t>(o_.turntable);
        const std::size_t count = o_.inputs.size() * objects.moments * turns;
        double before_seconds = watch.lap();
        // From the whole print down to its first part: what one picture has made, the next one mostly keeps.
        for (std::size_t moment = objects.moments; moment-- > 0;) {
            if (moment + 1 < objects.moments) {
                objects.showMoment(moment);
                before_seconds = watch.lap();
            }
            const bool first = moment + 1 == objects.moments;
            for (std::size_t turn = 0; turn < turns; ++turn) {
                shade::SceneDescription view = *scene_;
                if (turn > 0)
                    view.camera =
                        scene_->camera.turned(360.0 * static_cast<double>(turn) / static_cast<double>(turns), middle_);
                reports_.push_back(renderFrame(
                    o_,
                    {fs::path(o_.inputs[n]).filename().string(),
                     numbered(o_.output, (n * objects.moments + moment) * turns + turn, count),
                     first ? objects.load_seconds : 0.0, (first ? objects.build_seconds : 0.0) + before_seconds},
                    objects, view, threads_));
                watch.lap();
            }
        }
    }

    TraceCommand o_;  // with what is found on the way: exposure, what the files are
    int threads_;
    TraceOptions reading_;
    std::optional<shade::SceneDescription> scene_;
    glm::dvec3 middle_{0.0};
    Json reports_ = Json::array();
};

}  // namespace

Json traceSeries(const TraceCommand& o, int threads, Batch& batch) {
    Series series(o, threads);
    // From the last, which is the whole print and gives the camera, the bed and the light to all.
    for (std::size_t n = o.inputs.size(); n-- > 0;) batch.attempt(o.inputs[n], [&] { series.trace(n); });
    return series.reports();
}

}  // namespace stratum::tools
