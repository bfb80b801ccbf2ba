// Reading a whole level set of a .vdb: on all threads, against the check of the file and OpenVDB's reader after it.
//
// Both read the same file in turns, in one process and from warm pages, so that what disturbs the machine disturbs
// both.
#include "base/input_file.h"
#include "march/file/level_set_file.h"
#include "march/file/vdb_check.h"
#include "study/cost/times.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <vector>

using namespace stratum;
using study::median;

namespace {

openvdb::FloatGrid::Ptr readByOpenVdb(const std::string& path, const std::string& name) {
    const InputFile input(path);
    march::checkVdb(input.bytes(), march::VdbDepth::leaves, name, path);
    openvdb::io::File file(path);
    file.open(/*delayLoad=*/false);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times the reading of a level set against OpenVDB's own");
    std::string input;
    int runs = 5;
    std::size_t threads = 2;
    app.add_option("input", input, ".vdb")->required();
    app.add_option("--runs", runs, "Of each");
    app.add_option("--threads", threads, "Of both; OpenVDB uses one");
    CLI11_PARSE(app, argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    openvdb::initialize();
    std::string name;
    std::vector<double> own;
    std::vector<double> peer;
    std::vector<double> ratio;
    // The first round warms the file's pages and the process' memory, and is not counted.
    for (int n = 0; n <= runs; ++n) {
        openvdb::FloatGrid::Ptr grid;
        const study::Times ours = study::timesOf([&] { grid = march::readLevelSet(input); });
        name = grid->getName();
        grid.reset();
        const study::Times theirs = study::timesOf([&] { grid = readByOpenVdb(input, name); });
        if (n == 0) continue;
        own.push_back(ours.wall);
        peer.push_back(theirs.wall);
        ratio.push_back(theirs.wall / ours.wall);
        fmt::print("{:.3f} s (CPU {:.3f} s), OpenVDB {:.3f} s (CPU {:.3f} s): {:.2f} times\n", ours.wall, ours.cpu,
                   theirs.wall, theirs.cpu, ratio.back());
    }
    fmt::print("{}: median {:.3f} s, OpenVDB {:.3f} s, ratio {:.2f} ({:.2f}-{:.2f})\n", input, median(own),
               median(peer), median(ratio), *std::min_element(ratio.begin(), ratio.end()),
               *std::max_element(ratio.begin(), ratio.end()));
    return 0;
}
