// Beads to a level set: this project's voxelizer against OpenVDB's own ways, on the same beads, in one process.
//
// Peers: ParticlesToLevelSet (spheres along each bead, as users of OpenVDB do it), meshToVolume of the beads
// tessellated as tubes of 10 vertices a section. Runs are interleaved; medians and the spread are printed, times per
// active voxel of the grid that this project makes.
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <fmt/format.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/ParticlesToLevelSet.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <numbers>
#include <numeric>

namespace {

using namespace stratum;
using study::Times;
using study::timesOf;

// Spheres of the bead's half-height along its centre line and its two flats' edges, half a voxel apart: what a user of
// ParticlesToLevelSet has to do, for it knows no capsules.
struct Spheres {
    using PosType = openvdb::Vec3R;
    std::vector<openvdb::Vec4d> spheres;
    std::size_t size() const { return spheres.size(); }
    void getPos(std::size_t n, PosType& p) const { p = PosType(spheres[n][0], spheres[n][1], spheres[n][2]); }
    void getPosRad(std::size_t n, PosType& p, openvdb::Real& r) const {
        getPos(n, p);
        r = spheres[n][3];
    }
    void getPosRadVel(std::size_t n, PosType& p, openvdb::Real& r, PosType& v) const {
        getPosRad(n, p, r);
        v = PosType(0);
    }
};

// Points along a bead's path, at most `step` mm apart, both ends included.
std::vector<openvdb::Vec3d> pathPoints(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double step) {
    const double drop = voxelize::sectionOf(toolpath, bead).drop;
    const int count = std::max(1, static_cast<int>(std::ceil(gcode::beadLength(toolpath, bead) / step)));
    std::vector<openvdb::Vec3d> points;
    for (int n = 0; n <= count; ++n) {
        const double t = static_cast<double>(n) / count;
        double x = std::lerp(bead.x0, bead.x1, t);
        double y = std::lerp(bead.y0, bead.y1, t);
        if (bead.arc >= 0) {
            const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
            const double radius = std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
            const double angle = std::atan2(bead.y0 - arc.center_y, bead.x0 - arc.center_x) + t * arc.sweep;
            x = arc.center_x + radius * std::cos(angle);
            y = arc.center_y + radius * std::sin(angle);
        }
        points.emplace_back(x, y, std::lerp(bead.z0, bead.z1, t) - drop);
    }
    return points;
}

Spheres spheresOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double voxel) {
    Spheres out;
    for (const std::uint32_t index : beads) {
        const gcode::Bead& bead = toolpath.beads[index];
        const voxelize::Section section = voxelize::sectionOf(toolpath, bead);
        openvdb::Vec3d along(bead.x1 - bead.x0, bead.y1 - bead.y0, 0);
        along.normalize();
        const openvdb::Vec3d side(-along[1], along[0], 0);
        const int rows = 1 + static_cast<int>(std::ceil(2 * section.half_flat / voxel));
        for (const openvdb::Vec3d& p : pathPoints(toolpath, bead, 0.5 * voxel))
            for (int row = 0; row < rows; ++row) {
                const double offset = rows == 1 ? 0 : section.half_flat * (2.0 * row / (rows - 1) - 1);
                const openvdb::Vec3d q = p + side * offset;
                out.spheres.emplace_back(q[0], q[1], q[2], section.radius);
            }
    }
    return out;
}

struct Mesh {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
};

// Each bead a closed tube of ten vertices a section: two flats and two half circles of four edges.
Mesh tubesOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads) {
    constexpr std::uint32_t kSides = 10;
    Mesh mesh;
    for (const std::uint32_t index : beads) {
        const gcode::Bead& bead = toolpath.beads[index];
        const voxelize::Section section = voxelize::sectionOf(toolpath, bead);
        const auto path = pathPoints(toolpath, bead, bead.arc < 0 ? 1e9 : 0.5);
        const auto base = static_cast<std::uint32_t>(mesh.points.size());
        for (std::size_t n = 0; n < path.size(); ++n) {
            openvdb::Vec3d along = path[std::min(n + 1, path.size() - 1)] - path[n > 0 ? n - 1 : 0];
            if (along.length() == 0) along = openvdb::Vec3d(1, 0, 0);
            along.normalize();
            const openvdb::Vec3d side = openvdb::Vec3d(-along[1], along[0], 0);
            for (std::uint32_t s = 0; s < kSides; ++s) {
                const bool right = s < kSides / 2;
                const double angle =
                    std::numbers::pi * ((right ? s : s - kSides / 2) / 4.0 - 0.5) + (right ? 0 : std::numbers::pi);
                const double across = (right ? 1 : -1) * section.half_flat + section.radius * std::cos(angle);
                mesh.points.emplace_back(path[n] + side * across +
                                         openvdb::Vec3d(0, 0, section.radius * std::sin(angle)));
            }
        }
        for (std::uint32_t n = 0; n + 1 < path.size(); ++n)
            for (std::uint32_t s = 0; s < kSides; ++s) {
                const std::uint32_t a = base + n * kSides + s;
                const std::uint32_t b = base + n * kSides + (s + 1) % kSides;
                mesh.quads.emplace_back(a, b, b + kSides, a + kSides);
            }
        for (const std::uint32_t cap : {base, static_cast<std::uint32_t>(mesh.points.size()) - kSides})
            for (std::uint32_t s = 0; s < 4; ++s)
                mesh.quads.emplace_back(cap + s, cap + s + 1, cap + kSides - 2 - s, cap + kSides - 1 - s);
    }
    return mesh;
}

struct Series {
    std::string name;
    std::function<void()> work;
    int most_runs = 1000;
    std::vector<Times> times = {};
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times the voxelizer against OpenVDB's tools on the beads of a print");
    std::string input;
    double voxel = 0.1;
    std::size_t most = 20000;
    int runs = 5;
    int peer_runs = 2;
    std::size_t threads = 2;
    app.add_option("input", input, "G-code")->required();
    app.add_option("--voxel-size", voxel, "mm");
    app.add_option("--beads", most, "Only the first N beads; 0 is all");
    app.add_option("--runs", runs, "Of this project and of first touch");
    app.add_option("--peer-runs", peer_runs, "Of OpenVDB's tools; 0 leaves them out");
    app.add_option("--threads", threads, "Of all");
    CLI11_PARSE(app, argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    openvdb::initialize();

    const gcode::Toolpath toolpath = study::readPrint(input);
    std::vector<std::uint32_t> beads = voxelize::selectBeads(toolpath, {});
    if (most != 0 && beads.size() > most) beads.resize(most);
    const auto lattice = study::latticeOf(toolpath, beads, voxel);

    openvdb::FloatGrid::Ptr grid = voxelize::voxelize(toolpath, beads, lattice);
    const auto active = static_cast<double>(grid->activeVoxelCount());
    const std::size_t leaves = grid->tree().leafCount();
    fmt::print("{}: {} beads, voxel {:g} mm, {} active voxels, {} leaves, {} threads, {}\n", input, beads.size(), voxel,
               grid->activeVoxelCount(), leaves, threads, voxelize::kernelTarget());
    grid.reset();

    std::vector<Series> series;
    series.push_back({"voxelize", [&] { voxelize::voxelize(toolpath, beads, lattice); }});
    const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    if (peer_runs > 0) {
        series.push_back({"ParticlesToLevelSet",
                          [&] {
                              const Spheres spheres = spheresOf(toolpath, beads, voxel);
                              auto out = openvdb::createLevelSet<openvdb::FloatGrid>(voxel);
                              openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*out);
                              raster.setGrainSize(4096);
                              raster.setRmin(0.5);
                              raster.rasterizeSpheres(spheres);
                              raster.finalize();
                          },
                          peer_runs});
        series.push_back({"meshToVolume, 10-gon tubes",
                          [&] {
                              Mesh mesh = tubesOf(toolpath, beads);
                              for (auto& p : mesh.points) p = openvdb::Vec3s(transform->worldToIndex(p));
                              const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec4I> adapter(
                                  mesh.points, mesh.quads);
                              openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform);
                          },
                          peer_runs});
    }
    for (int run = 0; run < runs; ++run)
        for (Series& s : series)
            if (run < s.most_runs) s.times.push_back(timesOf(s.work));
    double reference = 0;
    fmt::print("{:28} {:>9}  {:>17}  {:>9}  {:>9}  {:>7}\n", "", "wall s", "spread", "ns/voxel", "CPU ns", "ratio");
    for (Series& s : series) {
        std::sort(s.times.begin(), s.times.end(), [](const Times& a, const Times& b) { return a.wall < b.wall; });
        const double median = s.times[s.times.size() / 2].wall;
        std::vector<double> cpu;
        for (const Times& t : s.times) cpu.push_back(t.cpu);
        if (reference == 0) reference = median;
        fmt::print("{:28} {:9.3f}  {:8.3f}-{:8.3f}  {:9.2f}  {:9.2f}  {:7.1f}\n", s.name, median, s.times.front().wall,
                   s.times.back().wall, median / active * 1e9, study::median(cpu) / active * 1e9, median / reference);
    }
    return 0;
}
