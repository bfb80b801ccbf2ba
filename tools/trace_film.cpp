#include "trace_film.h"

#include "progress.h"
#include "trace_frame.h"
#include "trace_shard.h"

#include "animate/encode/film_file.h"
#include "animate/kept_frames.h"
#include "animate/moving_scene.h"
#include "animate/pace.h"
#include "assemble/file/file_facts.h"
#include "base/error.h"
#include "gcode/container/container.h"
#include "shade/film/picture.h"
#include "shade/parts/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

namespace stratum::tools {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

// Whether it is one print of G-code that stands where its file says.
bool isPrintAlone(const TraceCommand& o) {
    if (o.objects.size() > 1) return false;
    if (o.objects.empty()) return !assemble::isVdbFile(o.inputs.front());
    const assemble::ObjectOptions& object = o.objects.front();
    return !object.sdf && object.placement.isIdentity() && !assemble::isVdbFile(object.vdb);
}

void refuseOthers(const TraceCommand& o) {
    const std::string& film = o.film.output;
    const auto refuse = [&film](std::string_view option, std::string_view why) {
        throw UsageError(fmt::format("--film {}: {} {}", film, option, why));
    };
    if (!o.output.empty()) refuse("-o", "names a picture; the film is named by --film alone");
    if (o.each || o.inputs.size() > 1) refuse("several inputs", "make several films; call vdbtrace for each");
    if (gcode::isStream(o.inputs.front()))
        refuse(o.inputs.front(), "is a stream, which is read once, and a film must know it again; name a file");
    if (o.tracing.prints.series > 1)
        refuse("--progress-series", "makes pictures; write --grow filament, or --grow time");
    if (!o.render.aovs.empty()) refuse("--aov", "is for .exr pictures");
    if (!o.render.checkpoint.empty())
        refuse("--checkpoint", "is for one picture; a film keeps its finished frames by itself");
    if (!o.write_brdf.empty()) refuse("--write-brdf", "is for pictures");
    if (o.scene.transparent) refuse("--background none", "is for pictures; films have no alpha");
    if (!o.film.camera_path.empty() && o.film.turn) refuse("--camera-path", "and --turntable move the same camera");
    if (!o.shard.by.empty() && o.shard.by != "frames") refuse("--shard-by", "frames is the only way to divide a film");
}

animate::FilmFormat formatOf(const TraceCommand& o, int threads) {
    animate::FilmFormat format;
    format.width = o.render.crop ? o.render.crop->width() : o.render.width;
    format.height = o.render.crop ? o.render.crop->height() : o.render.height;
    format.frames = o.film.frames;
    format.rate = o.film.rate;
    format.threads = threads;
    format.metadata = {{"Software", "vdbtrace " STRATUM_VERSION},
                       {"Source", fs::path(o.inputs.front()).filename().string()}};
    return format;
}

class FilmRun {
public:
    FilmRun(const TraceCommand& o, int threads)
        : o_(o),
          threads_(threads),
          format_(formatOf(o, threads)),
          kept_(o.film.output + ".frames", filmIdentity(o), format_.width, format_.height) {
        last_ = o.film.frames;
        if (o.shard.text.empty()) return;
        shard_ = givenShard(o.shard.text);
        std::tie(first_, last_) = shade::chunkOf(o.film.frames, *shard_);
    }

    Json run() {
        std::unique_ptr<animate::FilmFile> file;
        if (!shard_) file = animate::makeFilmFile(o_.film.output, format_);
        bool all_kept = true;
        for (std::size_t n = first_; n < last_; ++n) all_kept = all_kept && kept_.has(n);
        if (!all_kept) load();
        try {
            makeFrames(file.get());
            if (file) file->finish();
        } catch (const OutputError& error) {
            throw OutputError(fmt::format("{}{}", error.what(), remedy()));
        }
        encode_seconds_ += watch_.lap();
        if (file) kept_.remove();
        tell();
        return report();
    }

private:
    std::string remedy() const {
        std::error_code missing;
        if (!fs::is_directory(kept_.folder(), missing)) return {};
        return fmt::format("; finished frames are kept in {}, and the same command goes on from there",
                           kept_.folder().string());
    }

    void load() {
        assemble::TracingOptions reading = readingOf(o_);
        const FilmCommand& film = o_.film;
        animate::Motion motion;
        motion.frames = film.frames;
        motion.grow = !film.grow.empty();
        motion.turns = film.turn ? film.turns : 0.0;
        motion.held = film.held;
        motion.nozzle = o_.nozzle;
        const double ease = film.ease * film.rate;  // frames
        motion.ease = ease / static_cast<double>(film.frames);
        motion.path = film.keys;
        if (motion.grow)
            reading.prints.growth = {
                *valueOf(kGrowths, film.grow),
                animate::growthShares(film.frames, film.held, ease / static_cast<double>(film.frames - film.held))};
        const assemble::StageOptions options = stageOptionsOf(o_);
        const int turns = film.turn ? static_cast<int>(film.frames) : 1;
        if (o_.objects.empty() && film.keys.empty())
            reading.prints.pixel_spread = [&](const voxelize::Bounds& print, const voxelize::Bounds& part,
                                              std::span<const glm::dvec3> outline) {
                return assemble::pixelSpreadOf(options, print, part, outline, nullptr, turns);
            };
        assemble::TracedObjects objects = assemble::readTracedObjects(objectsOf(o_, 0), reading);
        for (const std::string& line : objects.lines) say(o_.common, line);
        if (o_.legend && objects.legends.empty()) say(o_.common, "  no legend: nothing is coloured by an attribute");
        load_seconds_ = objects.load_seconds;
        assemble::StageOptions first = options;
        if (!film.keys.empty()) animate::placeAt(film.keys.front(), first.scene.camera);
        assemble::Stage stage = assemble::makeStage(objects, first, reading.events);
        if (stage.exposure) o_.tone.exposure = *stage.exposure;
        for (const std::string& note : stage.scene.material->notes()) say(o_.common, "  material: " + note);
        scene_.emplace(std::move(objects), std::move(stage), options, std::move(motion));
        build_seconds_ = std::max(0.0, watch_.lap() - load_seconds_);
    }

    /// @param file  null: the frames are kept for another process
    void makeFrames(animate::FilmFile* file) {
        std::optional<ProgressBar> bar;
        std::vector<std::uint8_t> pixels;
        bool before = false;  // whether `pixels` are of the frame before
        for (std::size_t n = first_; n < last_; ++n) {
            const auto share = [this, n](double done) {
                return (static_cast<double>(n - first_) + done) / static_cast<double>(last_ - first_);
            };
            if (file == nullptr && kept_.has(n)) {
                ++reused_;
                before = false;
                continue;
            }
            if (std::optional<std::vector<std::uint8_t>> known = kept_.read(n)) {
                pixels = *std::move(known);
                ++reused_;
            } else {
                if (!scene_) {
                    bar.reset();
                    load();
                }
                if (before && scene_->repeats(n))
                    ++repeated_;
                else
                    pixels = render(n, bar, share);
                (void)watch_.lap();
                kept_.keep(n, pixels);
                keep_seconds_ += watch_.lap();
            }
            before = true;
            (void)watch_.lap();
            if (file != nullptr) file->add(pixels);
            encode_seconds_ += watch_.lap();
            if (!bar) bar.emplace("film", o_.common.quiet);
            bar->show(share(1.0));
        }
    }

    std::vector<std::uint8_t> render(std::size_t n, std::optional<ProgressBar>& bar,
                                     const std::function<double(double)>& share) {
        if (!bar) bar.emplace("film", o_.common.quiet);
        std::function<void(double)> rendering;
        if (bar->callback()) rendering = [&](double done) { bar->show(share(0.9 * done)); };
        (void)watch_.lap();
        scene_->show(n);
        const Rendered rendered = renderPicture(o_, *scene_->objects().intersector, scene_->scene(), rendering, {},
                                                [&](shade::Film& film) { scene_->drawOver(film, whiteOf(o_)); });
        const auto& legends = scene_->objects().legends;
        std::vector<std::uint8_t> pixels = shade::displayPixels(
            rendered.result.film, o_.tone, o_.legend && !legends.empty() ? &legends.front() : nullptr);
        rays_.primary += rendered.result.rays.primary;
        rays_.shadow += rendered.result.rays.shadow;
        rays_.bounce += rendered.result.rays.bounce;
        ++rendered_;
        const double seconds = watch_.lap();
        denoise_seconds_ += rendered.denoise_seconds;
        render_seconds_ += seconds - rendered.denoise_seconds;
        return pixels;
    }

    void tell() const {
        const double total =
            load_seconds_ + build_seconds_ + render_seconds_ + denoise_seconds_ + keep_seconds_ + encode_seconds_;
        const std::string frames =
            reused_ > 0 ? fmt::format("{} frames, {} of them were there already", last_ - first_, reused_)
                        : fmt::format("{} frames", last_ - first_);
        if (shard_) {
            say(o_.common, fmt::format("  {}: {} of {}; without --shard the same command makes the film",
                                       kept_.folder().string(), frames, o_.film.frames));
            return;
        }
        say(o_.common, fmt::format("  {}: {} x {}, {} at {:.5g} a second, {:.2f} s in all", o_.film.output,
                                   format_.width, format_.height, frames, o_.film.rate, total));
    }

    Json report() const {
        Json json{{"input", Json()},
                  {"output", shard_ ? kept_.folder().string() : o_.film.output},
                  {"film",
                   {{"frames", o_.film.frames},
                    {"fps", o_.film.rate},
                    {"seconds", static_cast<double>(o_.film.frames) / o_.film.rate},
                    {"grow", o_.film.grow.empty() ? Json() : Json(o_.film.grow)},
                    {"turns", o_.film.turn ? o_.film.turns : 0.0},
                    {"camera_path", o_.film.camera_path.empty() ? Json() : Json(o_.film.camera_path)},
                    {"held", o_.film.held},
                    {"ease_seconds", o_.film.ease},
                    {"nozzle", nameOf(assemble::kHotEnds, o_.nozzle.kind)},
                    {"hot_end", nameOf(assemble::kHotEndShapes, o_.nozzle.shape)},
                    {"rendered", rendered_},
                    {"repeated", repeated_},
                    {"reused", reused_}}},
                  {"image",
                   {{"width", format_.width},
                    {"height", format_.height},
                    {"spp", o_.render.spp},
                    {"exposure", o_.tone.exposure},
                    {"denoised", o_.denoise.value_or(false)}}},
                  {"rays", raysReport(rays_)},
                  {"integrator", o_.render.integrator.name},
                  {"notes", o_.notes},
                  {"seconds",
                   {{"load", load_seconds_},
                    {"build", build_seconds_},
                    {"render", render_seconds_},
                    {"denoise", denoise_seconds_},
                    {"keep", keep_seconds_},
                    {"encode", encode_seconds_},
                    {"total", load_seconds_ + build_seconds_ + render_seconds_ + denoise_seconds_ + keep_seconds_ +
                                  encode_seconds_}}},
                  {"peak_rss_bytes", peakRssBytes()},
                  {"threads", threads_}};
        if (scene_) {
            const assemble::TracedObjects& objects = scene_->objects();
            json["input"] = objects.reports.size() == 1 ? objects.reports.front() : Json{{"objects", objects.reports}};
            json["on_demand"] = assemble::onDemandReport(objects);
        }
        Json skipped = Json::array();
        if (repeated_ > 0)
            skipped.push_back({{"what", fmt::format("{} frames", repeated_)},
                               {"why", "nothing moves in them"},
                               {"saved", "their rays"}});
        json["skipped"] = std::move(skipped);
        return json;
    }

    TraceCommand o_;  // with the exposure that is found
    int threads_;
    animate::FilmFormat format_;
    animate::KeptFrames kept_;
    std::optional<shade::Shard> shard_;
    std::size_t first_ = 0, last_ = 0;
    std::optional<animate::MovingScene> scene_;
    Stopwatch watch_;
    shade::RayCounts rays_;
    std::size_t rendered_ = 0, repeated_ = 0, reused_ = 0;
    double load_seconds_ = 0.0, build_seconds_ = 0.0, render_seconds_ = 0.0, denoise_seconds_ = 0.0;
    double keep_seconds_ = 0.0, encode_seconds_ = 0.0;
};

// How many frames show the finished print, and whether there is time to ease.
void planPace(FilmCommand& film) {
    constexpr double kUsual = 1.0, kShort = 4.0;  // seconds
    if (film.hold && film.grow.empty())
        throw UsageError("--hold: shows the end of a print that grows; write --grow time");
    if (film.ease > 0 && film.grow.empty() && !film.turn)
        throw UsageError("--ease: is for a print that grows and for --turntable; the keys of --camera-path have times");
    if (!film.grow.empty()) {
        const double hold = film.hold.value_or(film.seconds >= kShort ? kUsual : 0.0);
        film.held = static_cast<std::size_t>(std::round(hold * film.rate));
        if (film.held > 0 && film.held >= film.frames)
            throw UsageError(
                fmt::format("--hold {}: the film has {:g} s, and the print must grow in them", hold, film.seconds));
    }
    const double moving = static_cast<double>(film.frames - film.held) / film.rate;
    if (film.ease > 0.5 * moving)
        throw UsageError(fmt::format("--ease {}: half of what moves at most, which takes {:g} s", film.ease, moving));
}

}  // namespace

void planFilm(TraceCommand& o) {
    FilmCommand& film = o.film;
    refuseOthers(o);
    const animate::FilmKind kind = animate::filmKindOf(film.output);
    const bool print = isPrintAlone(o);
    if (!film.grow.empty() && !print)
        throw UsageError("--grow: needs G-code, one print alone: a level set doesn't know what was printed when");
    if (!film.camera_path.empty()) film.keys = animate::readCameraKeys(film.camera_path);
    if (film.grow.empty() && film.camera_path.empty() && !film.turn) {
        if (print)
            film.grow = "time";
        else
            film.turn = true;
    }
    if (!film.seconds_given) {
        constexpr double kUsual = 8.0;
        film.seconds = film.keys.empty() ? kUsual : animate::durationOf(film.keys);
    }
    film.rate = film.rate == 0 ? animate::usualRate(kind) : animate::ratioOf(film.rate).perSecond();
    constexpr double kMostFrames = 1e6;
    const double frames = std::round(film.seconds * film.rate);
    if (!(frames >= 0 && frames <= kMostFrames))
        throw UsageError(
            fmt::format("--film {}: has {:.0f} frames; a film has at most {:.0f}", film.output, frames, kMostFrames));
    film.frames = static_cast<std::size_t>(frames);
    planPace(film);
    o.scene.camera.all_around = film.turn;
    o.linear = false;
    animate::requireFilm(film.output, formatOf(o, 0));
}

Json traceFilm(const TraceCommand& o, int threads) { return FilmRun(o, threads).run(); }

}  // namespace stratum::tools
