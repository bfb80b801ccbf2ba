#include "trace_series.h"

#include "terminal_events.h"
#include "trace_frame.h"
#include "trace_shard.h"

#include "assemble/hot_end.h"
#include "assemble/ready_scene.h"
#include "base/error.h"
#include "shade/camera/pixel_size.h"
#include "shade/measured/brdf_file.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

assemble::TracingOptions readingOf(const TraceCommand& o) {
    assemble::TracingOptions reading;
    reading.march = assemble::parseMarchMethod(o.march);
    reading.values = o.values;
    reading.clip = o.clip_planes;
    reading.prints = o.prints;
    reading.finishes = o.finishes;
    reading.hash = !o.render.checkpoint.empty();
    reading.events = terminalEvents(o.common.quiet);
    if (!o.brick_cache.empty()) {
        if (o.march != "auto" && o.march != "brick")
            throw UsageError(fmt::format("--brick-cache: --march {} has no bricks", o.march));
        reading.brick_cache = static_cast<std::size_t>(std::min(voxelize::parseSize(o.brick_cache), 1e18));
    }
    return assemble::tracingFor(o.scene, o.render, std::move(reading));
}

std::vector<assemble::ObjectOptions> objectsOf(const TraceCommand& o, std::size_t n) {
    std::vector<assemble::ObjectOptions> wanted = o.objects;
    if (wanted.empty()) {
        wanted.emplace_back();
        wanted.back().vdb = o.inputs[n];
        wanted.back().grid = o.grid;
        wanted.back().up = o.file_up;
    }
    return wanted;
}

assemble::StageOptions stageOptionsOf(const TraceCommand& o) {
    return {o.scene, o.render, o.frame == "all", !o.linear && !o.exposure_given};
}

namespace {

// --write-brdf: the objects have one material.
void requireOneMaterial(const assemble::TracedObjects& objects) {
    if (!objects.legends.empty())
        throw UsageError(
            "--write-brdf: writes one material, and here each place has a colour of its own; name one "
            "with --brdf");
    if (objects.brdfs.size() > 1)
        throw UsageError(
            fmt::format("--write-brdf: writes one material, and the objects have {}: {}; trace one of "
                        "them with --brdf",
                        objects.brdfs.size(), fmt::join(objects.brdfs, "; ")));
}

class Series {
public:
    Series(const TraceCommand& o, int threads) : o_(o), threads_(threads), reading_(readingOf(o)) {
        if (!o.objects.empty()) return;
        reading_.prints.pixel_spread = [this](const voxelize::Bounds& print, const voxelize::Bounds& part,
                                              std::span<const glm::dvec3> outline) {
            return assemble::pixelSpreadOf(stageOptionsOf(o_), print, part, outline, scene_ ? &scene_->camera : nullptr,
                                           o_.turntable);
        };
    }

    /// Frames of one input, which all have the camera, the bed and the light of the first that is traced.
    void trace(std::size_t n) {
        // Its pictures may be another process's; but the camera of all is of the first that is traced.
        const std::size_t each = pictures(o_) / o_.inputs.size();
        bool needed = !scene_;
        for (std::size_t k = n * each; k < (n + 1) * each; ++k) needed = needed || makes(o_, k);
        if (!needed) return;
        assemble::TracedObjects objects = assemble::readTracedObjects(objectsOf(o_, n), reading_);
        if (o_.prints.series > 1 && !assemble::growingPrint(objects))
            throw UsageError("--progress-series needs G-code: level sets don't know what was printed when");
        for (const std::string& line : objects.lines) say(o_.common, line);
        if (o_.legend && objects.legends.empty()) say(o_.common, "  no legend: nothing is coloured by an attribute");
        Stopwatch watch;
        if (!scene_) begin(objects);
        if (!o_.render.checkpoint.empty()) o_.render.source = sourceOf(o_, objects.source);
        scene_->objects = objects.materials;
        scene_->labels = objects.labels;
        if (o_.nozzle.kind != assemble::HotEndKind::none) hot_end_.emplace(objects, *scene_, o_.nozzle);
        frames(n, objects, watch);
    }

    const Json& reports() const { return reports_; }

private:
    void begin(const assemble::TracedObjects& objects) {
        if (!o_.write_brdf.empty()) requireOneMaterial(objects);
        assemble::Stage stage = assemble::makeStage(objects, stageOptionsOf(o_), reading_.events);
        scene_ = std::move(stage.scene);
        middle_ = stage.middle;
        if (stage.exposure) o_.tone.exposure = *stage.exposure;
        for (const std::string& note : scene_->material->notes()) say(o_.common, "  material: " + note);
        if (!o_.write_brdf.empty()) shade::writeBrdfFile(o_.write_brdf, *scene_->material);
    }

    /// @param objects  whose intersector becomes that of each picture
    void frames(std::size_t n, assemble::TracedObjects& objects, Stopwatch& watch) {
        const std::shared_ptr<assemble::LazyPrint> growing = assemble::growingPrint(objects);
        const std::size_t moments = growing != nullptr ? growing->moments() : 1;
        const auto turns = static_cast<std::size_t>(o_.turntable);
        double before_seconds = watch.lap();
        // From the whole print down to its first part: what one picture has made, the next one mostly keeps.
        bool first = true;
        for (std::size_t moment = moments; moment-- > 0;) {
            const std::size_t before = (n * moments + moment) * turns;
            bool any = false;
            for (std::size_t turn = 0; turn < turns; ++turn) any = any || makes(o_, before + turn);
            if (!any) continue;
            if (moment + 1 < moments) {
                growing->show(moment);
                before_seconds = watch.lap();
            }
            if (hot_end_) objects.intersector = hot_end_->at(moment);
            for (std::size_t turn = 0; turn < turns; ++turn) {
                if (!makes(o_, before + turn)) continue;
                shade::SceneDescription view = *scene_;
                if (turn > 0)
                    view.camera =
                        scene_->camera.turned(360.0 * static_cast<double>(turn) / static_cast<double>(turns), middle_);
                reports_.push_back(renderFrame(
                    o_,
                    {fs::path(o_.inputs[n]).filename().string(), before + turn, first ? objects.load_seconds : 0.0,
                     (first ? objects.build_seconds : 0.0) + before_seconds,
                     [&](shade::Film& film) {
                         if (hot_end_) hot_end_->drawOver(moment, view.camera, whiteOf(o_), film);
                     }},
                    objects, view, threads_));
                watch.lap();
            }
            first = false;
        }
    }

    TraceCommand o_;  // with what is found on the way: exposure, what the files are
    int threads_;
    assemble::TracingOptions reading_;
    std::optional<shade::SceneDescription> scene_;
    std::optional<assemble::HotEnd> hot_end_;  // of the input that is traced, with --nozzle
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
