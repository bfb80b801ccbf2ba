// What culling saves: a print with all its inner surfaces against the same print as the outside sees it.
//
// The peer is OpenVDB's extractEnclosedRegion, which finds the enclosed voids of a grid that has been built whole.
#include "export/vdb_file.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetPlatonic.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <ctime>

namespace {

using namespace stratum;
using Clock = std::chrono::steady_clock;

double peakGigabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024e-9;
}

// The half of the print behind the middle of y, closed by the cut.
void writeHalf(const openvdb::FloatGrid& grid, const std::string& path) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    openvdb::Vec3d low = grid.indexToWorld(box.min().offsetBy(-8));
    const openvdb::Vec3d high = grid.indexToWorld(box.max().offsetBy(8));
    low[1] = 0.5 * (low[1] + high[1]);
    const auto knife = openvdb::tools::createLevelSetBox<openvdb::FloatGrid>(
        openvdb::BBoxd(low, high), grid.transform(), grid.background() / grid.voxelSize()[0]);
    const auto half = openvdb::tools::csgIntersectionCopy(grid, *knife);
    half->setName("surface");
    exporter::writeVdb({half}, path);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Compares a kept and a culled grid of one print");
    std::string input;
    double voxel = 0.1;
    bool keep = true;
    std::size_t threads = 2;
    app.add_option("input", input, "G-code")->required();
    app.add_option("--voxel-size", voxel, "mm");
    bool peer = true;
    app.add_flag("!--no-peer", peer, "Leave out OpenVDB's extractEnclosedRegion");
    bool reached = true;
    app.add_flag("!--no-cull", reached, "Keep only");
    app.add_flag("!--no-keep", keep, "Cull only: for prints whose whole grid does not fit");
    app.add_option("--threads", threads, "Of all");
    std::string cut;
    app.add_option("--cut", cut, "Also write PREFIX_keep.vdb and PREFIX_cull.vdb, cut open along the middle of y")
        ->type_name("PREFIX");
    CLI11_PARSE(app, argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    openvdb::initialize();

    const gcode::Toolpath toolpath = study::readPrint(input);
    const auto beads = voxelize::selectBeads(toolpath, {});
    const auto lattice = study::latticeOf(toolpath, beads, voxel);
    fmt::print("{}: {} beads, {:.1f} cm3, voxel {:g} mm\n", input, beads.size(), gcode::beadVolume(toolpath) * 1e-3,
               voxel);

    double active[2] = {};
    double leaves[2] = {};
    double seconds[2] = {};
    for (const int cull : {1, 0}) {
        if (cull == 0 ? !keep : !reached) continue;
        voxelize::VoxelizeOptions options;
        options.interior = cull != 0 ? voxelize::Interior::cull : voxelize::Interior::keep;
        const auto start = Clock::now();
        const std::clock_t cpu = std::clock();
        voxelize::Voxelizer voxelizer(toolpath, beads, lattice, options);
        const auto grid = voxelizer.printAll();
        seconds[cull] = std::chrono::duration<double>(Clock::now() - start).count();
        const double cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
        active[cull] = static_cast<double>(grid->activeVoxelCount());
        leaves[cull] = static_cast<double>(grid->tree().leafCount());
        const auto& report = voxelizer.report();
        fmt::print(
            "{}: {:.2f} s (CPU {:.2f}; bins {:.2f}), {:.1f} M active, {:.0f} k leaves of {:.0f} k positions, {} "
            "evaluated, {:.2f} GB "
            "grid, peak {:.2f} GB",
            cull != 0 ? "cull" : "keep", seconds[cull], cpu_seconds, report.bin_seconds, active[cull] * 1e-6,
            leaves[cull] * 1e-3, static_cast<double>(report.leaf_positions) * 1e-3, report.leaves_evaluated,
            static_cast<double>(grid->memUsage()) * 1e-9, peakGigabytes());
        if (cull != 0)
            fmt::print(", {} rounds, exterior {:.2f} s ({:.0f} %)", report.flood_rounds, report.exterior_seconds,
                       100 * report.exterior_seconds / seconds[cull]);
        fmt::print("\n");
        if (!cut.empty()) writeHalf(*grid, cut + (cull != 0 ? "_cull.vdb" : "_keep.vdb"));
        if (cull == 0 && peer) {
            const auto begin = Clock::now();
            const auto enclosed = openvdb::tools::extractEnclosedRegion(*grid);
            fmt::print("extractEnclosedRegion: {:.2f} s\n",
                       std::chrono::duration<double>(Clock::now() - begin).count());
        }
    }
    if (keep && reached)
        fmt::print("keep / cull: {:.2f} x active, {:.2f} x leaves, {:.2f} x time\n", active[0] / active[1],
                   leaves[0] / leaves[1], seconds[0] / seconds[1]);
    return 0;
}
