#include "trace_shard.h"

#include "trace_frame.h"

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "shade/parts/frame_record.h"
#include "shade/parts/shard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread
    return value ? value : "";
}

/// A hash of a file's contents; empty for what is no file: a preset, whose name is among the options.
std::string contentHash(const std::string& path) {
    std::error_code missing;
    if (!std::filesystem::is_regular_file(path, missing)) return {};
    return sha256Hex(InputFile(path).bytes());
}

void refuse(const TraceCommand& o, bool pieces) {
    if (pieces && o.render.seconds > 0.0)
        throw UsageError(
            "--shard: --time gives its samples to the noisiest tiles of the whole picture; use --spp, --noise, "
            "or --shard-by frames");
    if (pieces && o.nozzle.kind == assemble::HotEndKind::clear)
        throw UsageError("--shard: --clear-nozzle is drawn into whole pictures; use --nozzle, or --shard-by frames");
    if (!pieces && !o.shard.resume) return;
    if (isStandardOutput(o.output))
        throw UsageError("--shard: a part can't go to standard output, nor be resumed there; name a file by -o");
    for (const std::string& input : o.inputs)
        if (gcode::isStream(input))
            throw UsageError(fmt::format(
                "--shard: every shard reads the input anew, and {} is a stream, which is read once; name a file",
                input));
}

/// Content of files by their names, each read once. What is no file is a preset, whose name is among the options.
class Contents {
public:
    const std::string& of(const std::string& path) {
        const auto [found, fresh] = hashes_.try_emplace(path);
        if (fresh) found->second = contentHash(path);
        return found->second;
    }

private:
    std::map<std::string, std::string> hashes_;
};

/// A hash of `what`, the options, and all files that a picture of these inputs depends on.
std::string hashOf(const TraceCommand& o, const std::string& what, const std::vector<std::string>& inputs,
                   Contents& contents) {
    std::string text = fmt::format("vdbtrace {}\n{}{}\n{}\n", STRATUM_VERSION, o.said, o.scene_text, what);
    const auto add = [&](const std::string& path) { text += contents.of(path) + "\n"; };
    for (const std::string& input : inputs) {
        text += fs::path(input).filename().string() + "\n";
        if (o.objects.empty()) add(input);
    }
    for (const std::string& file : inputFilesOf(o)) add(file);
    return sha256Hex(text);
}

/// A hash of all that picture n depends on. The camera of a series is of its last input.
std::string sceneOf(const TraceCommand& o, std::size_t n, Contents& contents) {
    const std::size_t count = pictures(o);
    return hashOf(o, fmt::format("{} picture {} of {}", o.linear ? "linear" : "shown", n, count),
                  {o.inputs[n * o.inputs.size() / count], o.inputs.back()}, contents);
}

}  // namespace

shade::Shard givenShard(const std::string& text) {
    constexpr std::string_view kSlurm = "slurm";
    const std::string_view count = std::string_view(text).substr(std::min(kSlurm.size(), text.size()));
    if (!text.starts_with(kSlurm) || (!count.empty() && count.front() != '/')) return shade::parseShard(text);
    if (!count.empty()) return shade::parseShard(environment("SLURM_ARRAY_TASK_ID") + std::string(count));
    return shade::shardOf({environment("SLURM_ARRAY_TASK_ID"), environment("SLURM_ARRAY_TASK_MIN"),
                           environment("SLURM_ARRAY_TASK_MAX"), environment("SLURM_ARRAY_TASK_COUNT")});
}

std::string saidOf(const CLI::App& app) {
    // Where the output goes, what is reported, on how many threads and machines changes nothing of it.
    constexpr std::array<std::string_view, 12> kOther = {"output",   "film",   "checkpoint", "threads",
                                                         "stats",    "quiet",  "IN",         "shard",
                                                         "shard-by", "resume", "summary",    "force"};
    std::string said;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_single_name();
        if (option->count() == 0 || std::find(kOther.begin(), kOther.end(), name) != kOther.end()) continue;
        said += fmt::format("{} {}\n", name, fmt::join(option->results(), " "));
    }
    return said;
}

std::size_t pictures(const TraceCommand& o) {
    return o.inputs.size() * static_cast<std::size_t>(o.tracing.prints.series) * static_cast<std::size_t>(o.turntable);
}

std::string outputOf(const TraceCommand& o, std::size_t n) {
    const std::string name = numbered(o.output, n, pictures(o));
    return o.shard.pieces ? shade::shardName(name, *o.shard.shard, ".exr").string() : name;
}

bool makes(const TraceCommand& o, std::size_t n) { return o.shard.made.empty() || o.shard.made[n]; }

void divide(std::vector<TraceCommand>& commands) {
    if (commands.empty() || commands.front().shard.text.empty()) return;
    const ShardCommand& given = commands.front().shard;
    const shade::Shard shard = givenShard(given.text);
    std::size_t count = 0;
    for (const TraceCommand& o : commands) count += pictures(o);
    const bool series = count > 1 || commands.front().each;
    const bool pieces = given.by.empty() ? !series : given.by != "frames";
    const auto [first, last] = pieces ? std::pair<std::size_t, std::size_t>() : shade::chunkOf(count, shard);
    std::size_t number = 0;
    for (TraceCommand& o : commands) {
        refuse(o, pieces);
        o.shard.shard = shard;
        o.shard.pieces = pieces;
        if (pieces) {
            if (!o.render.checkpoint.empty()) o.render.checkpoint = shade::shardName(o.render.checkpoint, shard);
            continue;
        }
        for (std::size_t n = 0; n < pictures(o); ++n, ++number)
            o.shard.made.push_back(number >= first && number < last);
    }
}

void identify(TraceCommand& o) {
    if (!o.shard.pieces && !o.shard.resume) return;
    (void)renderOptionsOf(o);  // too many shards fail now
    Contents contents;
    for (std::size_t n = 0; n < pictures(o); ++n)
        o.shard.scenes.push_back(makes(o, n) ? sceneOf(o, n, contents) : std::string());
    if (!o.shard.resume) return;
    const std::optional<shade::FrameRecord> record =
        o.shard.pieces ? std::nullopt : std::optional<shade::FrameRecord>(recordOf(o));
    o.shard.made.resize(pictures(o), true);
    for (std::size_t n = 0; n < pictures(o); ++n) {
        if (!o.shard.made[n]) continue;
        const std::string output = outputOf(o, n);
        const std::string& scene = o.shard.scenes[n];
        const bool there =
            record ? record->has(output, scene) : shade::isPartOf(output, STRATUM_VERSION, scene, *o.shard.shard);
        if (!there) continue;
        o.shard.made[n] = false;
        say(o.common, fmt::format("  {}: is this shard of this scene already, skipped", output));
    }
}

std::string filmIdentity(const TraceCommand& o) {
    Contents contents;
    return hashOf(o, fmt::format("a film of {} frames, grow {}, hold {}", o.film.frames, o.film.grow, o.film.held),
                  o.inputs, contents);
}

std::string recordOf(const TraceCommand& o) {
    if (!o.shard.resume || o.shard.pieces) return {};
    return shade::shardName(o.output, *o.shard.shard, ".done").string();
}

void recordPicture(const TraceCommand& o, std::size_t n) {
    const std::string record = recordOf(o);
    if (!record.empty()) shade::FrameRecord(record).add(outputOf(o, n), o.shard.scenes[n]);
}

shade::RenderOptions renderOptionsOf(const TraceCommand& o) {
    shade::RenderOptions options = o.render;
    if (!o.shard.pieces) return options;
    options.crop =
        shade::piecesOf(o.render.region(), o.shard.shard->count).at(static_cast<std::size_t>(o.shard.shard->index));
    options.margin = 0;  // the denoiser's is among the pieces
    return options;
}

void writePiece(shade::PictureFile& file, const TraceCommand& o, std::size_t n, const shade::RenderResult& result,
                const shade::Metadata& metadata, const shade::Legend* legend) {
    shade::Part part;
    part.whole = {STRATUM_VERSION,
                  o.shard.scenes[n],
                  o.render.width,
                  o.render.height,
                  o.render.region(),
                  o.render.crop,
                  o.linear,
                  o.denoise.value_or(false),
                  o.tone.exposure,
                  legend ? std::optional(*legend) : std::nullopt,
                  o.shard.shard->count,
                  result.film.transparent() ? std::optional(result.film.bareBed()) : std::nullopt};
    part.index = o.shard.shard->index;
    part.samples = result.samples;
    part.pixels = result.pixels;
    part.metadata = metadata;
    shade::writePart(file, result.film, std::move(part));
}

}  // namespace stratum::tools
