#include "trace_frame.h"

#include "progress.h"
#include "terminal_events.h"
#include "trace_shard.h"

#include "assemble/finished_picture.h"
#include "assemble/hot_end.h"
#include "assemble/ready_scene.h"
#include "base/error.h"
#include "shade/camera/pixel_size.h"
#include "shade/film/picture.h"
#include "shade/integrator/radiance_cache.h"
#include "shade/measured/brdf_file.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

shade::Progress progressOf(const std::function<void(double)>& show) {
    if (!show) return {};
    return
        [show](std::uint64_t done, std::uint64_t all) { show(static_cast<double>(done) / static_cast<double>(all)); };
}

// What this picture did not need.
Json skippedBy(const TraceCommand& o, const assemble::TracedObjects& objects, const shade::SceneDescription& scene,
               const shade::Film& film) {
    Json skipped = Json::array();
    const auto skip = [&skipped](const char* what, const char* why, const char* saved) {
        skipped.push_back({{"what", what}, {"why", why}, {"saved", saved}});
    };
    if (!scene.bed) skip("bed", o.scene.bed ? "the camera is below it" : "--no-bed", "its shading and bounces");
    if (!objects.no_color_lookup.empty())
        skip("colour of each place", objects.no_color_lookup.c_str(), "an attribute lookup a hit");
    if (scene.lights.empty()) skip("lamps", "none asked for", "one shadow ray a hit and light");
    if (film.content() != shade::FilmContent::radiance)
        skip("light and material", "the integrator does not shade", "shadow and bounce rays");
    if (o.render.integrator.exact_translucency && scene.anyTranslucent())
        skip("radiance cache", "--exact-translucency", "the paths that fill it");
    else if (shade::maxComponent(scene.ambient) > 0.0f && scene.anyTranslucent())
        skip("radiance cache", "ambient light, which it can't hold", "the paths that fill it");
    if (!scene.smooth_normals)
        skip("smooth normals", "not asked for", "keeping the level set besides its bricks, 56 samples a hit");
    return skipped;
}

Json radianceCacheReport(const shade::RenderResult& result) {
    const shade::RadianceCache* const cache = result.radiance_cache.get();
    if (cache == nullptr) return nullptr;
    return {{"paths", cache->paths()},
            {"vertices", cache->vertices()},
            {"cells", cache->known()},
            {"bytes", cache->bytes()},
            {"seconds", result.radiance_cache_seconds}};
}

struct Seconds {
    double render = 0.0, denoise = 0.0, write = 0.0, total = 0.0;
};

Json reportOf(const TraceCommand& o, const Frame& frame, const std::string& output,
              const assemble::TracedObjects& objects, const shade::SceneDescription& scene,
              const shade::RenderResult& result, const Seconds& seconds, int threads) {
    const shade::RayCounts& rays = result.rays;
    Json material = objects.material_report;
    material["notes"] = scene.material->notes();
    return {{"input", objects.reports.size() == 1 ? objects.reports.front() : Json{{"objects", objects.reports}}},
            {"output", output},
            {"image",
             {{"width", o.render.width},
              {"height", o.render.height},
              {"spp", o.render.spp},
              {"mean_spp", result.mean_spp},
              {"exposure", o.tone.exposure},
              {"denoised", o.denoise.value_or(false)}}},
            {"rays", raysReport(rays)},
            {"radiance_cache", radianceCacheReport(result)},
            {"march", objects.intersector->name()},
            {"march_bytes", objects.intersector->bytes()},
            {"on_demand", assemble::onDemandReport(objects)},
            {"integrator", o.render.integrator.name},
            {"material", material},
            {"notes", o.notes},
            {"seconds",
             {{"load", frame.load_seconds},
              {"build", frame.build_seconds},
              {"render", seconds.render},
              {"denoise", seconds.denoise},
              {"write", seconds.write},
              {"total", seconds.total}}},
            {"mrays_per_second", static_cast<double>(rays.total()) / seconds.render * 1e-6},
            {"peak_rss_bytes", peakRssBytes()},
            {"threads", threads},
            {"skipped", skippedBy(o, objects, scene, result.film)}};
}

}  // namespace

std::string numbered(const std::string& output, std::size_t number, std::size_t count) {
    if (count == 1) return output;
    const fs::path path(output);
    const int digits = std::max(3, static_cast<int>(std::to_string(count - 1).size()));
    return (path.parent_path() /
            fmt::format("{}_{:0{}}{}", path.stem().string(), number, digits, path.extension().string()))
        .string();
}

Json raysReport(const shade::RayCounts& rays) {
    return {{"primary", rays.primary}, {"shadow", rays.shadow}, {"bounce", rays.bounce}, {"total", rays.total()}};
}

Rendered renderPicture(const TraceCommand& o, const trace::Intersector& print, const shade::SceneDescription& scene,
                       const std::function<void(double)>& rendering, const std::function<void(double)>& denoising,
                       const DrawOver& over) {
    Stopwatch watch;
    Rendered rendered;
    rendered.result = shade::render(print, scene, renderOptionsOf(o), progressOf(rendering));
    rendered.render_seconds = watch.lap();
    if (o.shard.pieces) return rendered;
    shade::Film& film = rendered.result.film;
    if (o.denoise.value_or(false)) {
        shade::denoise(film, progressOf(denoising));
        if (o.render.crop && film.region() != *o.render.crop) film = film.part(*o.render.crop);
    }
    if (over) over(film);
    rendered.denoise_seconds = watch.lap();
    return rendered;
}

double whiteOf(const TraceCommand& o) { return std::exp2(-o.tone.exposure); }

Json renderFrame(const TraceCommand& o, const Frame& frame, const assemble::TracedObjects& objects,
                 const shade::SceneDescription& scene, int threads) {
    Stopwatch watch;
    const std::string output = outputOf(o, frame.number);
    shade::PictureFile picture(output);
    const shade::RenderOptions options = renderOptionsOf(o);
    const bool denoised = o.denoise.value_or(false);
    Seconds seconds;
    const Rendered rendered = [&] {
        std::optional<ProgressBar> bar;
        bar.emplace("rendering", o.common.quiet);
        const auto rendering = bar->callback();
        std::function<void(double)> denoising;
        if (rendering)
            denoising = [&bar, &o, begun = false](double done) mutable {
                if (!std::exchange(begun, true)) bar.emplace("denoising", o.common.quiet);
                bar->show(done);
            };
        return renderPicture(o, *objects.intersector, scene, rendering, denoising, frame.over);
    }();
    const shade::RenderResult& result = rendered.result;
    seconds.render = rendered.render_seconds;
    seconds.denoise = rendered.denoise_seconds;
    (void)watch.lap();

    shade::Metadata metadata =
        assemble::metadataOf(frame.source, o.render, o.scene.env, objects, scene, result, denoised);
    const bool shown = !o.linear && result.film.content() == shade::FilmContent::radiance;
    if (shown) metadata.insert(assemble::exposureFact(o.tone));
    const shade::Legend* legend = o.legend && !objects.legends.empty() ? &objects.legends.front() : nullptr;
    {
        const ProgressNote note("writing", o.common.quiet);
        if (o.shard.pieces)
            writePiece(picture, o, frame.number, result, metadata, legend);
        else
            picture.write(result.film, metadata, o.tone, legend);
        recordPicture(o, frame.number);
    }
    if (!options.checkpoint.empty()) fs::remove(options.checkpoint);  // the picture is there
    seconds.write = watch.lap();
    seconds.total = frame.load_seconds + frame.build_seconds + seconds.render + seconds.denoise + seconds.write;

    const shade::RayCounts& rays = result.rays;
    std::string piece;
    if (result.film.width() != o.render.width || result.film.height() != o.render.height)
        piece = fmt::format("{} x {} of ", result.film.width(), result.film.height());
    say(o.common,
        fmt::format("  {}: {}{} x {} at {:.4g} spp, {} rays, {:.1f} Mrays/s, {:.2f} s in all", output, piece,
                    o.render.width, o.render.height, result.mean_spp, humanCount(static_cast<double>(rays.total())),
                    static_cast<double>(rays.total()) / seconds.render * 1e-6, seconds.total));
    if (shown && !o.exposure && o.tone.exposure != 0.0)
        say(o.common,
            fmt::format("  exposure {:+.2f} stops, found from the light; --exposure sets it", o.tone.exposure));
    return reportOf(o, frame, output, objects, scene, result, seconds, threads);
}

assemble::TracingOptions readingOf(const TraceCommand& o) {
    assemble::TracingOptions reading = o.tracing;
    reading.hash = !o.render.checkpoint.empty();
    reading.events = terminalEvents(o.common.quiet);
    return assemble::tracingFor(o.scene, o.render, std::move(reading));
}

std::vector<assemble::ObjectOptions> objectsOf(const TraceCommand& o, std::size_t n) {
    if (!o.objects.empty()) return o.objects;
    return {{.vdb = o.inputs[n], .grid = o.grid, .up = o.file_up}};
}

assemble::StageOptions stageOptionsOf(const TraceCommand& o) {
    return {o.scene, o.render, o.frame_all, !o.linear && !o.exposure};
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
        if (o_.tracing.prints.series > 1 && !assemble::growingPrint(objects))
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
