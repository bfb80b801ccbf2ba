#include "convert/convert_shard.h"

#include "shard_option.h"

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "export/mesh_file.h"
#include "gcode/container/input_bytes.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>

namespace stratum::tools {
namespace {

namespace fs = std::filesystem;

void refuseWhole(const ConvertCommand& o, const std::vector<fs::path>& outputs) {
    const auto refuse = [](std::string_view what, std::string_view why) {
        throw UsageError(fmt::format("--shard: {} {}", what, why));
    };
    for (const fs::path& output : outputs) {
        if (exporter::isMeshPath(output))
            refuse(output.string(), "is a mesh, which is made of the whole level set; write a .vdb");
        if (isStandardOutput(output)) refuse("a part", "can't go to standard output; name a file by -o");
    }
    for (const std::string& input : o.inputs)
        if (gcode::isStream(input))
            refuse(input, "is a stream, which is read once, and every shard reads the input anew; name a file");
    const char* one = "leave it out, or make it without --shard";
    if (!voxelize::parseGrids(o.grids).empty())
        refuse("--grids", fmt::format("makes grids beside the level set, of the whole print; {}", one));
    if (!o.snapshots.empty()) refuse("--snapshots", fmt::format("goes on from one print to the next; {}", one));
    if (o.interior == "cull")
        refuse("--interior cull", fmt::format("finds what the outside reaches in the whole print; {}", one));
    if (o.interior_distance) refuse("--interior-distance", fmt::format("sweeps through the whole level set; {}", one));
    if (o.forecast) refuse("--forecast", fmt::format("counts in the whole level set; {}", one));
    if (o.report.asked()) refuse("--report", "measures the whole level set; make it without --shard");
    if (o.usda) refuse("--usda", "stands beside the whole level set; make it without --shard");
    if (!o.dump_toolpath.empty())
        refuse("--dump-toolpath", "would be written by every shard; write it by a run without --shard");
}

}  // namespace

void divide(ConvertCommand& o, std::vector<fs::path>& outputs) {
    if (o.shard.text.empty()) return;
    refuseWhole(o, outputs);
    o.shard.shard = givenShard(o.shard.text);
    for (fs::path& output : outputs) output = shardName(output, *o.shard.shard);
}

exporter::PartOfPrint partOf(const ConvertCommand& o, const std::string& input) {
    exporter::PartOfPrint part;
    part.shard = *o.shard.shard;
    part.version = STRATUM_VERSION;
    part.scene =
        sha256Hex(fmt::format("gcode2vdb {}\n{}{}\n{}\n{}\n", STRATUM_VERSION, o.shard.said,
                              fs::path(input).filename().string(), contentHash(input), contentHash(o.print.printer)));
    return part;
}

}  // namespace stratum::tools
