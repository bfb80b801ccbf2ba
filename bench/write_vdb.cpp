// Writing of .vdb files beside OpenVDB's own writer: a grid that is there, and a whole print from its beads on.
//
// Each run is a process of its own, in turns, so that the peak of its memory is its own and no run finds the pages of
// another. OpenVDB's files are flushed to the disk as ours are; --out /dev/shm leaves the disk out.
#include "export/vdb_file.h"
#include "export/vdb_stream.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

using namespace stratum;

namespace {

struct Options {
    std::string input;
    double voxel = 0.1;
    int runs = 5;
    std::size_t threads = 2;
    std::filesystem::path out = std::filesystem::temp_directory_path();
};

struct Outcome {
    double write = 0, whole = 0;  // s
    std::size_t bytes = 0, peak = 0;
};

enum class Writer { openvdb, ours, stream };

void flush(const std::filesystem::path& path) {
    const int fd = ::open(path.c_str(), O_RDONLY);
    if (fd < 0 || ::fsync(fd) != 0) throw std::runtime_error("can't flush " + path.string());
    ::close(fd);
}

Outcome run(const Options& o, Writer writer) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, o.threads);
    openvdb::initialize();
    const gcode::Toolpath toolpath = study::readPrint(o.input);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const auto lattice = study::latticeOf(toolpath, beads, o.voxel);
    const auto path = o.out / fmt::format("stratum_bench_{}.vdb", ::getpid());
    Outcome outcome;
    outcome.whole = study::timesOf([&] {
                        voxelize::VoxelizeOptions options;
                        if (writer == Writer::stream) options.bytes_per_leaf = 0;
                        voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
                        if (writer == Writer::stream) {
                            const auto bounds = voxelizer.leafBounds();
                            exporter::VdbStream file(voxelizer.emptyGrid(), path, {}, bounds);
                            voxelizer.stream(0xffffffff, bounds, file, false);
                            file.finish();
                            return;
                        }
                        const auto grid = voxelizer.printAll();
                        outcome.write =
                            study::timesOf([&] {
                                if (writer == Writer::ours) {
                                    exporter::writeVdb({grid}, path);
                                    return;
                                }
                                openvdb::io::File file(path.string());
                                file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
                                file.write({grid});
                                file.close();
                                flush(path);
                            }).wall;
                    }).wall;
    outcome.bytes = std::filesystem::file_size(path);
    std::filesystem::remove(path);
    return outcome;
}

Outcome inChild(const Options& o, Writer writer) {
    const study::Outcome child = study::inOwnProcess([&] {
        const Outcome one = run(o, writer);
        return fmt::format("{} {} {}", one.write, one.whole, one.bytes);
    });
    if (!child.failure.empty()) throw std::runtime_error(child.failure);
    Outcome one;
    std::istringstream(child.text) >> one.write >> one.whole >> one.bytes;
    one.peak = child.peak_rss_bytes;
    return one;
}

std::string spread(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return fmt::format("{:.2f} ({:.2f}..{:.2f})", values[values.size() / 2], values.front(), values.back());
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times writing .vdb files beside OpenVDB's writer");
    Options o;
    app.add_option("input", o.input, "G-code")->required();
    app.add_option("--voxel-size", o.voxel, "mm");
    app.add_option("--runs", o.runs, "Of each");
    app.add_option("--threads", o.threads, "Of all");
    app.add_option("--out", o.out, "Folder to write to");
    CLI11_PARSE(app, argc, argv);
    std::vector<double> theirs, ours, streamed, write_ratio, whole_ratio;
    Outcome last[3];
    for (int n = 0; n < o.runs; ++n) {
        for (const Writer writer : {Writer::openvdb, Writer::ours, Writer::stream})
            last[static_cast<int>(writer)] = inChild(o, writer);
        theirs.push_back(last[0].write);
        ours.push_back(last[1].write);
        streamed.push_back(last[2].whole);
        write_ratio.push_back(last[0].write / last[1].write);
        whole_ratio.push_back(last[0].whole / last[2].whole);
    }
    fmt::print("{}: {:g} mm, {:.1f} MB of OpenVDB, {:.1f} MB of ours, {} threads, {} runs in turns\n", o.input, o.voxel,
               static_cast<double>(last[0].bytes) * 1e-6, static_cast<double>(last[2].bytes) * 1e-6, o.threads, o.runs);
    fmt::print("a grid in memory: OpenVDB {} s, ours {} s, {} times as fast\n", spread(theirs), spread(ours),
               spread(write_ratio));
    fmt::print("from beads to the file: leaf by leaf {} s, {} times as fast as a grid and OpenVDB\n", spread(streamed),
               spread(whole_ratio));
    fmt::print("peak memory: {:.0f} MB with a grid, {:.0f} MB leaf by leaf: 1 / {:.1f}\n",
               static_cast<double>(last[0].peak) * 1e-6, static_cast<double>(last[2].peak) * 1e-6,
               static_cast<double>(last[0].peak) / static_cast<double>(last[2].peak));
    return 0;
}
