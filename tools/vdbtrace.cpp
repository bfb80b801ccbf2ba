// vdbtrace: level set -> picture.
#include "batch.h"
#include "command_line.h"
#include "command_source.h"
#include "output_names.h"
#include "print_options.h"
#include "run_files.h"
#include "shade/environment/environment.h"
#include "trace_film.h"
#include "trace_frame.h"
#include "trace_options.h"
#include "trace_shard.h"

#include "assemble/file/file_facts.h"
#include "assemble/finished_picture.h"
#include "assemble/shape/shape.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "shade/film/picture.h"
#include "shade/integrator/integrator.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What can't be read is told of when its turn comes.
bool isLevelSet(const std::string& path) {
    try {
        return assemble::isVdbFile(path);
    } catch (const InputError&) {
        return false;
    }
}

// What is asked of G-code has some.
void checkPrints(const tools::TraceCommand& o, std::vector<std::string> given_of_prints) {
    if (!o.tool_colors.empty()) given_of_prints.emplace_back("--color");
    if (given_of_prints.empty()) return;
    if (o.objects.empty()) {
        for (const std::string& input : o.inputs)
            if (isLevelSet(input)) tools::refusePrintOptions(given_of_prints, input);
    } else if (std::none_of(o.objects.begin(), o.objects.end(), [](const assemble::ObjectOptions& object) {
                   return !object.sdf && !isLevelSet(object.vdb);
               })) {
        tools::refusePrintOptions(given_of_prints, "every object of " + o.inputs.front());
    }
}

void checkNozzle(const tools::TraceCommand& o) {
    if (o.nozzle.kind == assemble::HotEndKind::none) return;
    if (o.objects.size() > 1 || (o.objects.size() == 1 && !o.objects.front().placement.isIdentity()))
        throw UsageError("--nozzle is of one print alone, which stands where its file says");
    if (!o.file_up.empty()) throw UsageError("--nozzle stands above a print, whose z is up; leave out --file-up");
    if (o.nozzle.kind == assemble::HotEndKind::clear && !shade::needsLight(o.render.integrator))
        throw UsageError(
            fmt::format("--clear-nozzle is drawn into pictures of light, not of --integrator {}; write --nozzle",
                        o.render.integrator.name));
}

// What is asked of the pictures fits together. Before the work.
void check(tools::TraceCommand& o, const std::vector<std::string>& given_of_prints) {
    o.linear = shade::PictureFile(o.output).linear();  // a bad name fails before the work
    shade::requirePictureSize(o.output, o.render.width, o.render.height);
    if (o.scene.transparent) shade::requireAlpha(o.output);
    if (o.scene.transparent && o.legend)
        throw UsageError("--legend is drawn onto what is behind the print; leave --background none or the legend out");
    if (!o.render.aovs.empty() && !o.linear)
        throw UsageError(fmt::format("--aov: layers need a picture that holds them; write an .exr, not {}", o.output));
    if (isStandardOutput(o.output) && tools::pictures(o) > 1)
        throw UsageError(fmt::format("-o {}: only one picture can go to standard output; name a file for the {}",
                                     o.output, tools::pictures(o)));
    if (!o.render.checkpoint.empty() && tools::pictures(o) > 1)
        throw UsageError("--checkpoint is for one picture; render the frames of a series one by one");
    if (o.tracing.prints.series > 1 && o.inputs.size() * std::max<std::size_t>(1, o.objects.size()) > 1)
        throw UsageError("--progress-series is of one print alone");
    checkNozzle(o);
    if (const std::string given = tools::givenFilmOptions(o.film); !given.empty())
        throw UsageError(fmt::format("{}: of films alone; name one, e.g. --film part.mp4", given));
    if (o.legend && o.linear)
        throw UsageError(fmt::format("--legend is drawn into pictures to look at, e.g. a .png, not {}", o.output));
    checkPrints(o, given_of_prints);
}

// Whether any of its pictures are this process's: of a series, some shards have none of an input.
bool makesAny(const tools::TraceCommand& o) {
    for (std::size_t n = 0; n < tools::pictures(o); ++n)
        if (tools::makes(o, n)) return true;
    return false;
}

void listFiles(tools::RunFiles& files, const tools::TraceCommand& o, const std::string& option) {
    files.reads(o.scene_file);
    for (const std::string& input : o.inputs) files.reads(input);
    for (const std::string& file : tools::inputFilesOf(o)) files.reads(file);
    if (!o.film.output.empty()) return files.writes(o.film.output, "--film");
    for (std::size_t n = 0; n < tools::pictures(o); ++n) files.writes(tools::outputOf(o, n), option);
    files.writes(tools::recordOf(o), "--resume");
    files.writes(o.render.checkpoint, "--checkpoint");
    files.writes(o.write_brdf, "--write-brdf");
}

// --each: commands of one input each, without those that fail.
std::vector<tools::TraceCommand> split(const tools::TraceCommand& whole, tools::Batch& batch, const CLI::App& app) {
    if (!whole.output.empty() && !tools::namesFolder(whole.output) && fs::path(whole.output).has_extension())
        throw UsageError(
            fmt::format("-o {}: with --each it names the folder of the pictures, e.g. -o pictures", whole.output));
    std::vector<tools::TraceCommand> commands;
    for (const std::string& input : whole.inputs) {
        tools::TraceCommand one = whole;
        one.inputs = {input};
        if (!batch.attempt(input, [&] { tools::readPictureOptions(one, app); })) continue;
        const fs::path folder = whole.output.empty() ? fs::path(input).parent_path() : fs::path(whole.output);
        one.output = (folder / (tools::stemOf(input) + (one.render.aovs.empty() ? ".png" : ".exr"))).string();
        one.each = true;
        commands.push_back(std::move(one));
    }
    return commands;
}

// Where the pictures of a command without --each go.
void nameOutput(tools::TraceCommand& o) {
    const bool folder = tools::namesFolder(o.output);
    if (!o.output.empty() && !folder) return;
    const std::string stem = o.inputs.size() > 1 ? tools::commonStem(o.inputs) : tools::stemOf(o.inputs.front());
    const std::string name = stem + (folder && !o.render.aovs.empty() ? ".exr" : ".png");
    o.output = (folder ? fs::path(o.output) / name : fs::path(name)).string();
}

void runFilm(tools::TraceCommand& o, const std::vector<std::string>& given_of_prints, const CLI::App& app) {
    tools::readPictureOptions(o, app);
    tools::planFilm(o);
    const tools::ThreadLimit limit(o.common.threads);
    tools::RunFiles files;
    listFiles(files, o, "--film");
    files.writesBeside(o.common.stats, "--stats");
    checkPrints(o, given_of_prints);
    checkNozzle(o);
    o.denoise = assemble::chooseDenoising(o.denoising(o.linear), o.render);
    for (const std::string& note : o.notes) tools::say(o.common, note);
    tools::writeStats(o.common, tools::traceFilm(o, limit.threads()));
}

void run(const CLI::App& app, tools::TraceCommand& whole, char** argv) {
    // Before standard input is read: the process starts itself once more. Bricks have huge pages of their own.
    tools::CommandSource options(app);
    if (!assemble::marchesBricks(options.choice("march", assemble::kMarchMethods).value_or(whole.tracing.march)))
        tools::useHugePages(argv);
    tools::keepFreedMemory();
    std::vector<std::string> given_of_prints = tools::givenPrintOptions(app);
    if (!whole.film.output.empty()) return runFilm(whole, given_of_prints, app);
    const bool folder = whole.each || tools::namesFolder(whole.output);
    const bool named = !folder && !whole.output.empty();
    tools::Batch batch("vdbtrace", whole.inputs.size());
    std::vector<tools::TraceCommand> commands;
    if (whole.each) {
        commands = split(whole, batch, app);
    } else {
        tools::readPictureOptions(whole, app);
        nameOutput(whole);
        commands = {whole};
    }
    tools::divide(commands);
    const tools::ThreadLimit limit(whole.common.threads);
    tools::RunFiles files;
    for (const tools::TraceCommand& o : commands)
        for (const std::string& input : o.inputs) files.reads(input);
    for (const tools::TraceCommand& o : commands) listFiles(files, o, named ? "-o" : "");
    files.writesBeside(whole.common.stats, "--stats");
    for (tools::TraceCommand& o : commands) {
        o.common.output_on_stdout = isStandardOutput(o.output);
        if (folder) tools::makeFolder(fs::path(o.output).parent_path());
        check(o, given_of_prints);
    }

    Json reports = Json::array();
    const auto keep = [&reports](const Json& some) {
        for (const Json& report : some) reports.push_back(report);
    };
    for (tools::TraceCommand& o : commands) {
        o.denoise = assemble::chooseDenoising(o.denoising(o.linear), o.render);
        tools::identify(o);
        if (!makesAny(o)) continue;
        for (const std::string& note : o.notes) tools::say(o.common, note);
        if (!whole.each) {
            keep(tools::traceSeries(o, limit.threads(), batch));
            continue;
        }
        batch.attempt(o.inputs.front(), [&] {
            tools::Batch alone("vdbtrace", 1);
            keep(tools::traceSeries(o, limit.threads(), alone));
        });
    }
    keep(batch.failures());
    tools::writeStats(whole.common, reports.size() == 1 ? reports.front() : reports);
    batch.finish();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Ray-traces an OpenVDB level set into a picture.", "vdbtrace");
    tools::TraceCommand command;
    tools::addTraceOptions(app, command);
    return tools::runTool(app, argc, argv, [&] {
        command.said = tools::saidOf(app);
        run(app, command, argv);
    });
}
