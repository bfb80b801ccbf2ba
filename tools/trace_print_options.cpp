#include "trace_print_options.h"

#include "command_line.h"
#include "print_options.h"

#include "base/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace stratum::tools {

void addTracePrintOptions(CLI::App& app, assemble::PrintRequest& request, std::string& brick_cache) {
    app.add_option(
           "--brick-cache", brick_cache,
           "brick: no more than this of samples at once, e.g. 200MB; what no ray came to lately makes room, and "
           "the picture stays the same. Of each print, and of each large level set (default: no bound)")
        ->type_name("SIZE")
        ->group("Tracing");
    addGone(app, "--brick-picture", "--stats has how many bricks rays came to, bricks_made of bricks_listed");
    addPrintOptions(app, request.print, true);
    app.add_option("--printed", request.printed,
                   "G-code: what is printed by then: 25%, layer:40, time:90 (minutes; 5400s, 1.5h), or time:50%")
        ->type_name("WHEN")
        ->group("What to convert");
    app.add_option("--progress-series", request.series,
                   "G-code: N numbered pictures of a print that grows by equal volumes, one camera for all")
        ->check(CLI::Range(1, 100000))
        ->excludes("--printed")
        ->type_name("N")
        ->group("What to convert");
    app.add_flag("--by-time", request.series_by_time, "--progress-series: equal times instead of equal volumes")
        ->needs("--progress-series")
        ->group("What to convert");
}

std::vector<std::string> givenPrintOptions(const CLI::App& app) {
    constexpr std::array<std::string_view, 4> kGroups = {kLattice, kWhat, kPlastic, kReading};
    std::vector<std::string> given;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const bool of_prints = std::find(kGroups.begin(), kGroups.end(), option->get_group()) != kGroups.end();
        if (of_prints && option->count() > 0) given.push_back(name);
    }
    return given;
}

void refusePrintOptions(const std::vector<std::string>& given, const std::string& vdb) {
    if (given.empty()) return;
    const std::string& first = given.front();
    const bool in_time = first == "--printed" || first == "--progress-series";
    throw UsageError(
        fmt::format("{}: needs G-code, and {} is a level set, whose voxels are made; make it anew with gcode2vdb {}, "
                    "or give vdbtrace "
                    "the print itself",
                    fmt::join(given, ", "), vdb, in_time ? "--snapshots" : first));
}

}  // namespace stratum::tools
