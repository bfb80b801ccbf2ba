// A whole build in memory that the process has never touched, against the first touch of as many leaves.
//
// Each is a process of its own that first maps, writes and unmaps the same amount: on a virtual machine a page that the
// host has taken back costs ten times one that it has not, and both should find the machine in the same state. They
// take turns. Set GLIBC_TUNABLES=glibc.malloc.hugetlb=1, as the tools do for themselves, to build in huge pages.
#include "base/parallel_for.h"
#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

using namespace stratum;

namespace {

constexpr std::size_t kLeafBytes = sizeof(openvdb::FloatTree::LeafNodeType) + 2048;

struct Outcome {
    study::Times times;
    std::size_t leaves = 0;
    std::size_t active = 0;
    double bin_seconds = 0;
};

enum class Pages { small = MADV_NOHUGEPAGE, huge = MADV_HUGEPAGE };

// Writes `bytes` of fresh memory, leaf after leaf, and gives them back. Seconds of the writing.
study::Times touch(std::size_t bytes, Pages pages) {
    void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory");
    ::madvise(memory, bytes, static_cast<int>(pages));
    const study::Times times = study::timesOf([&] {
        parallelFor(bytes / kLeafBytes, 1024, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n != last; ++n)
                std::memset(static_cast<char*>(memory) + n * kLeafBytes, 1, kLeafBytes);
        });
    });
    ::munmap(memory, bytes);
    return times;
}

// In a child: what is freed there is not found by the next one.
template <typename Work>
Outcome inChild(const Work& work) {
    const study::Outcome child = study::inOwnProcess([&] {
        const Outcome o = work();
        return fmt::format("{} {} {} {} {}", o.times.wall, o.times.cpu, o.leaves, o.active, o.bin_seconds);
    });
    if (!child.failure.empty()) throw std::runtime_error(child.failure);
    Outcome o;
    std::istringstream(child.text) >> o.times.wall >> o.times.cpu >> o.leaves >> o.active >> o.bin_seconds;
    return o;
}

Outcome build(const std::string& input, double voxel, voxelize::Interior interior, std::size_t bytes, Pages pages) {
    openvdb::initialize();
    const gcode::Toolpath toolpath = study::readPrint(input);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const auto lattice = study::latticeOf(toolpath, beads, voxel);
    voxelize::VoxelizeOptions options;
    options.interior = interior;
    Outcome outcome;
    openvdb::FloatGrid::Ptr grid;
    if (bytes != 0) touch(bytes, pages);
    outcome.times = study::timesOf([&] {
        voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
        grid = voxelizer.printAll();
        outcome.bin_seconds = voxelizer.report().bin_seconds;
    });
    outcome.leaves = grid->tree().leafCount();
    outcome.active = grid->activeVoxelCount();
    return outcome;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times builds in fresh memory against the first touch of as many leaves");
    std::string input;
    double voxel = 0.1;
    int runs = 7;
    std::size_t threads = 2;
    bool cull = false;
    app.add_option("input", input, "G-code")->required();
    app.add_option("--voxel-size", voxel, "mm");
    app.add_option("--runs", runs, "Of each");
    app.add_option("--threads", threads, "Of both");
    app.add_flag("--cull", cull, "--interior cull");
    CLI11_PARSE(app, argc, argv);
    const auto interior = cull ? voxelize::Interior::cull : voxelize::Interior::keep;
    const auto limited = [&](const auto& work) {
        return inChild([&] {
            // In the child: threads don't survive a fork.
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            return work();
        });
    };

    const char* const tunables = std::getenv("GLIBC_TUNABLES");
    const bool huge = tunables != nullptr && std::strstr(tunables, "malloc.hugetlb=1") != nullptr;
    const Pages own = huge ? Pages::huge : Pages::small;
    const auto touched = [&](std::size_t bytes, Pages pages) {
        return limited([&] {
            touch(bytes, pages);
            return Outcome{touch(bytes, pages)};
        });
    };
    const Outcome first = limited([&] { return build(input, voxel, interior, 0, own); });
    const std::size_t bytes = first.leaves * kLeafBytes;
    fmt::print("{}: {:g} mm, {:.1f} M active voxels, {} leaves, {:.2f} GB, {} threads, built in {} pages\n", input,
               voxel, static_cast<double>(first.active) * 1e-6, first.leaves, static_cast<double>(bytes) * 1e-9,
               threads, huge ? "huge" : "small");
    fmt::print("{:>9} {:>9} {:>9} {:>14} {:>14}\n", "build s", "bins s", "CPU s", "touch small s", "touch huge s");
    std::vector<double> columns[3];
    for (int run = 0; run < runs; ++run) {
        const double small_pages = touched(bytes, Pages::small).times.wall;
        const double huge_pages = touched(bytes, Pages::huge).times.wall;
        const Outcome built = limited([&] { return build(input, voxel, interior, bytes, own); });
        columns[0].push_back(built.times.wall);
        columns[1].push_back(small_pages);
        columns[2].push_back(huge_pages);
        fmt::print("{:9.3f} {:9.3f} {:9.3f} {:14.3f} {:14.3f}\n", built.times.wall, built.bin_seconds, built.times.cpu,
                   small_pages, huge_pages);
    }
    double medians[3];
    for (int c = 0; c < 3; ++c) {
        std::sort(columns[c].begin(), columns[c].end());
        medians[c] = columns[c][columns[c].size() / 2];
    }
    fmt::print("medians: build {:.3f} s, {:.2f} x the first touch in small pages, {:.2f} x in huge ones\n", medians[0],
               medians[0] / medians[1], medians[0] / medians[2]);
    return 0;
}
