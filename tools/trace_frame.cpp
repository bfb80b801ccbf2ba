#include "trace_frame.h"

#include "progress.h"
#include "trace_shard.h"

#include "assemble/finished_picture.h"
#include "shade/film/picture.h"
#include "shade/integrator/radiance_cache.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

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
    if (o.shard.pieces) piece = fmt::format("{} x {} of ", result.film.width(), result.film.height());
    say(o.common,
        fmt::format("  {}: {}{} x {} at {:.4g} spp, {} rays, {:.1f} Mrays/s, {:.2f} s in all", output, piece,
                    o.render.width, o.render.height, result.mean_spp, humanCount(static_cast<double>(rays.total())),
                    static_cast<double>(rays.total()) / seconds.render * 1e-6, seconds.total));
    if (shown && !o.exposure_given && o.tone.exposure != 0.0)
        say(o.common,
            fmt::format("  exposure {:+.2f} stops, found from the light; --exposure sets it", o.tone.exposure));
    return reportOf(o, frame, output, objects, scene, result, seconds, threads);
}

}  // namespace stratum::tools
