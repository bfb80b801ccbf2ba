#include "convert/thumbnail_output.h"

#include "batch.h"
#include "command_line.h"
#include "output_names.h"
#include "run_files.h"
#include "terminal_events.h"

#include "assemble/thumbnail/print_thumbnails.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "deposit/read_print.h"
#include "gcode/container/container.h"
#include "gcode/thumbnail/thumbnail_file.h"
#include "gcode/toolpath/warning_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Names of level sets and meshes, which --thumbnail doesn't write, and of containers, which it doesn't change.
constexpr std::array<std::string_view, 6> kOthers = {".vdb", ".stl", ".ply", ".obj", ".inp", ".usda"};
constexpr std::array<std::string_view, 5> kContainers = {".bgcode", ".3mf", ".ufp", ".gx", ".gz"};

template <std::size_t N>
bool isOneOf(const std::string& ending, const std::array<std::string_view, N>& endings) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

std::string endingOf(const fs::path& path) { return lowerCase(path.extension().string()); }

void checkName(const std::string& input, const fs::path& output) {
    if (isStandardOutput(output)) return;
    const std::string to = endingOf(output);
    if (isOneOf(to, kOthers))
        throw UsageError(
            fmt::format("-o {}: --thumbnail writes G-code again, a copy of {} with new pictures; name it so, "
                        "and make the {} without --thumbnail",
                        output.string(), input, to));
    const std::string from = endingOf(input);
    if (input != "-" && from != to && (isOneOf(from, kContainers) || isOneOf(to, kContainers)))
        throw UsageError(fmt::format("-o {}: --thumbnail keeps the container of {}; give a name that ends in {}",
                                     output.string(), input, from.empty() ? ".gcode" : from));
}

// Where each input's copy goes.
std::vector<fs::path> outputsOf(const ConvertCommand& o) {
    const bool folder = o.inputs.size() > 1 || namesFolder(o.output);
    if (o.thumbnail.in_place && !o.output.empty())
        throw UsageError(fmt::format("-o {}: with --in-place the input is replaced; leave one of them out", o.output));
    if (!o.thumbnail.in_place && o.output.empty())
        throw UsageError("--thumbnail: name the new file with -o, or replace the input with --in-place");
    std::vector<fs::path> outputs;
    for (const std::string& input : o.inputs) {
        if (o.thumbnail.in_place && gcode::isStream(input))
            throw UsageError(fmt::format("--in-place: {} can't be replaced; name the new file with -o",
                                         input == "-" ? "standard input" : input));
        // The file that a link names, not the link.
        std::error_code missing;
        const fs::path itself = o.thumbnail.in_place ? fs::canonical(input, missing) : fs::path();
        outputs.push_back(o.thumbnail.in_place ? (missing ? fs::path(input) : itself)
                          : folder             ? fs::path(o.output) / fs::path(input).filename()
                                               : fs::path(o.output));
        checkName(input, outputs.back());
    }
    if (folder && !o.thumbnail.in_place) {
        if (fs::path(o.output).has_extension() && !namesFolder(o.output))
            throw UsageError(fmt::format("-o {}: of {} inputs it names the folder of the copies, e.g. -o pictured",
                                         o.output, o.inputs.size()));
        makeFolder(o.output);
    }
    return outputs;
}

Json writeOne(const ConvertCommand& o, const std::string& input, const fs::path& output,
              const std::vector<gcode::ThumbnailSize>& asked, int threads) {
    Stopwatch total;
    Stopwatch watch;
    const Replacement may(output, o.thumbnail.in_place);
    AtomicFile::probe(output);  // an unwritable place is found before the work
    const gcode::InputBytes file(input);
    const gcode::ThumbnailFile holder(file.bytes(), file.name(), asked, o.print.read.plate);
    const std::vector<gcode::ThumbnailSize> sizes = holder.pictures();
    assemble::ThumbnailOptions options{o.print, terminalEvents(o.common.quiet, "gcode2vdb")};
    auto print = [&] {
        const assemble::Step step(options.events, "reading", true);
        gcode::ReadOptions read = o.print.read;
        if (options.events.fraction) read.progress = options.events.fraction;
        return deposit::readPrint(file.bytes(), file.name(), read, false);
    }();
    const auto toolpath = std::make_shared<const gcode::Toolpath>(std::move(print.toolpath));
    if (!o.common.quiet)
        for (const gcode::Warning& warning : toolpath->warnings)
            tellError(fmt::format("gcode2vdb: {}\n", gcode::describe(warning, file.name())));
    const double parse = watch.lap();
    const std::vector<gcode::Thumbnail> pictures = assemble::makeThumbnails(toolpath, file.name(), sizes, options);
    const double render = watch.lap();
    const gcode::PatchedBytes patched = holder.patched(pictures);
    const fs::perms mode = o.thumbnail.in_place ? fs::status(output).permissions() : fs::perms::unknown;
    gcode::writePatched(patched, output);
    if (mode != fs::perms::unknown) {
        std::error_code ignored;  // some file systems have none
        fs::permissions(output, mode, ignored);
    }
    const double write = watch.lap();

    Json left_out = Json::array();
    for (const auto& [width, height, coding] : holder.leftOut())
        left_out.push_back(fmt::format("{}x{}/{}", width, height, gcode::codingName(coding)));
    if (!left_out.empty() && !o.common.quiet)
        tellError(fmt::format("gcode2vdb: {}: has no place for all pictures; not written: {}\n", file.name(),
                              fmt::join(left_out.get<std::vector<std::string>>(), ", ")));
    Json list = Json::array();
    std::string text;
    for (const gcode::Thumbnail& picture : pictures) {
        const auto& [width, height, coding] = picture.size;
        list.push_back({{"width", width},
                        {"height", height},
                        {"format", gcode::codingName(coding)},
                        {"bytes", picture.bytes.size()}});
        text += fmt::format("{}{}x{}/{}", text.empty() ? "" : ", ", width, height, gcode::codingName(coding));
    }
    const double seconds = total.lap();
    say(o.common, fmt::format("  {}: {}, {:.2f} s", output.string(), text, seconds));
    return {
        {"input",
         {{"path", input}, {"bytes", file.bytes().size()}, {"slicer", toolpath->slicer}, {"format", toolpath->format}}},
        {"output", output.string()},
        {"bytes", patched.size()},
        {"thumbnails", list},
        {"left_out", left_out},
        {"seconds", {{"parse", parse}, {"render", render}, {"write", write}, {"total", seconds}}},
        {"peak_rss_bytes", peakRssBytes()},
        {"threads", threads}};
}

}  // namespace

void addThumbnailOptions(CLI::App& app, ThumbnailCommand& o) {
    const char* group = "Thumbnails";
    auto* sizes =
        app.add_option("--thumbnail", o.sizes,
                       "Instead of a level set, a copy of the print with pictures of what it really prints, "
                       "for screens of printers: 300x300,16x16/QOI, each PNG, JPG or QOI. They take the place "
                       "of the file's own; all else stays")
            ->type_name("WxH[/KIND],...")
            ->group(group);
    app.add_flag("--in-place", o.in_place, "Replaces the input")->needs(sizes)->group(group);
    // All that is of level sets.
    for (const char* other : {"--unit", "--up", "--origin", "--interior", "--interior-distance", "--grids",
                              "--precision", "--compression", "--usda", "--mesh-error", "--faces", "--forecast",
                              "--snapshots", "--summary", "--dump-toolpath", "--compare", "--report", "--elastic"})
        sizes->excludes(app.get_option(other));
}

void writeThumbnails(ConvertCommand& o) {
    const std::vector<gcode::ThumbnailSize> asked = gcode::parseThumbnails(o.thumbnail.sizes);
    const std::vector<fs::path> outputs = outputsOf(o);
    RunFiles files;
    for (const std::string& input : o.inputs) files.reads(input);
    if (!o.thumbnail.in_place)
        for (const fs::path& output : outputs) files.writes(output.string(), "-o");
    files.writesBeside(o.common.stats, "--stats");
    o.common.output_on_stdout = isStandardOutput(outputs.front());

    const ThreadLimit limit(o.common.threads);
    Batch batch("gcode2vdb", o.inputs.size());
    Json reports = Json::array();
    for (std::size_t n = 0; n < o.inputs.size(); ++n)
        batch.attempt(o.inputs[n],
                      [&] { reports.push_back(writeOne(o, o.inputs[n], outputs[n], asked, limit.threads())); });
    for (const Json& failure : batch.failures()) reports.push_back(failure);
    writeStats(o.common, reports.size() == 1 ? reports.front() : reports);
    batch.finish();
}

}  // namespace stratum::tools
