// What a series of partial prints costs: the final grid alone against N steps that end with it, in one process.
//
// Both in memory that the process has used before; nothing is written.
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>

using namespace stratum;

int main(int argc, char** argv) {
    CLI::App app("Times a series of partial prints against the final one alone");
    std::string input;
    double voxel = 0.1;
    std::size_t steps = 20;
    int runs = 5;
    std::size_t threads = 2;
    bool cull = false;
    app.add_option("input", input, "G-code")->required();
    app.add_option("--voxel-size", voxel, "mm");
    app.add_option("--steps", steps, "Partial prints, the final one among them; equal numbers of beads each");
    app.add_option("--runs", runs, "Of each");
    app.add_option("--threads", threads, "Of both");
    app.add_flag("--cull", cull, "--interior cull");
    CLI11_PARSE(app, argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    openvdb::initialize();
    const gcode::Toolpath toolpath = study::readPrint(input);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const auto lattice = study::latticeOf(toolpath, beads, voxel);
    voxelize::VoxelizeOptions options;
    options.interior = cull ? voxelize::Interior::cull : voxelize::Interior::keep;
    const auto build = [&](std::size_t count) {
        return study::timesOf([&] {
            voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
            for (std::size_t step = 1; step <= count; ++step)
                voxelizer.printUntil(beads[step * beads.size() / count - 1] + 1);
        });
    };
    build(1);
    fmt::print("{}: {} beads, {:g} mm, {} steps\n{:>9} {:>9} {:>6}   {:>9} {:>9} {:>6}\n", input, beads.size(), voxel,
               steps, "one s", "series s", "times", "one CPU s", "series", "times");
    std::vector<double> wall;
    std::vector<double> cpu;
    for (int run = 0; run < runs; ++run) {
        const study::Times one = build(1);
        const study::Times series = build(steps);
        wall.push_back(series.wall / one.wall);
        cpu.push_back(series.cpu / one.cpu);
        fmt::print("{:9.3f} {:9.3f} {:6.2f}   {:9.3f} {:9.3f} {:6.2f}\n", one.wall, series.wall, wall.back(), one.cpu,
                   series.cpu, cpu.back());
    }
    std::sort(wall.begin(), wall.end());
    fmt::print("medians: {:.2f} ({:.2f}-{:.2f}) wall, {:.2f} CPU\n", wall[wall.size() / 2], wall.front(), wall.back(),
               study::median(cpu));
    return 0;
}
