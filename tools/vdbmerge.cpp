// vdbmerge: the parts of a picture -> the whole.
#include "command_line.h"
#include "run_files.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "shade/parts/merge.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;

constexpr const char* kExamples = R"(
Examples:
  vdbmerge part.png part.*of8.exr           what vdbtrace --shard 0/8 ... wrote
  vdbmerge part.exr part.*of8.exr           the same of vdbtrace -o part.exr
  vdbmerge - part.*of8.exr --quiet > part.png)";

struct MergeCommand {
    tools::CommonOptions common;
    std::string output;
    std::vector<std::string> parts;
};

void run(MergeCommand& o) {
    if (fs::path(o.output).extension() == ".vdb" || o.output == "-.vdb")
        throw UsageError(fmt::format(
            "{}: a level set has no parts; one process of gcode2vdb writes it whole (name a .png, .jpg, .webp or .exr)",
            o.output));
    const tools::ThreadLimit limit(o.common.threads);
    o.common.output_on_stdout = isStandardOutput(o.output);
    tools::RunFiles files;
    for (const std::string& part : o.parts) files.reads(part);
    files.writes(o.output, "OUT");
    files.writesBeside(o.common.stats, "--stats");
    Stopwatch watch;
    const shade::MergedPicture merged =
        shade::mergeParts(o.output, std::vector<fs::path>(o.parts.begin(), o.parts.end()));
    const double seconds = watch.lap();
    tools::say(o.common, fmt::format("  {}: {} x {} at {:.4g} spp of {} parts, {:.2f} s", o.output, merged.width,
                                     merged.height, merged.mean_spp, merged.parts, seconds));
    tools::writeStats(o.common, {{"output", o.output},
                                 {"width", merged.width},
                                 {"height", merged.height},
                                 {"parts", merged.parts},
                                 {"mean_spp", merged.mean_spp},
                                 {"denoised", merged.denoised},
                                 {"seconds", seconds},
                                 {"peak_rss_bytes", tools::peakRssBytes()}});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Merges the parts of a picture that vdbtrace --shard traced.", "vdbmerge");
    MergeCommand command;
    app.add_option("OUT", command.output,
                   "The picture, of the ending that vdbtrace -o had: .png, .jpg or .webp, denoised and exposed as one "
                   "process would, or .exr. The bytes are those of one process")
        ->required()
        ->type_name("FILE");
    app.add_option("PART", command.parts, "All parts, each once, in any order")->required()->type_name("FILE.exr");
    tools::addCommonOptions(app, command.common);
    app.footer(kExamples);
    return tools::runTool(app, argc, argv, [&command] { run(command); });
}
