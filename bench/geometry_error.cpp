// How far the level set's surface lies from the exact union of the beads, against voxels a layer.
//
// Rays from outside meet the trilinear surface; the distance of each hit from the union is computed by brute force over
// all beads, in double. The law that --tolerance uses was fitted to this program's output.
#include "march/brick_intersector.h"
#include "parallel/parallel_for.h"
#include "study/print.h"
#include "study/times.h"
#include "toolpaths.h"
#include "voxelize/bead_field.h"
#include "voxelize/selection.h"
#include "voxelize/voxelizer.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <random>

using namespace stratum;

int main(int argc, char** argv) {
    CLI::App app("Measures the distance between the level set's surface and the beads' exact union");
    std::string input;
    std::string layers = "1:";
    std::vector<double> counts{1, 2, 3, 4, 6, 8};
    double shift = 0;
    std::size_t rays = 40000;
    app.add_option("input", input, "G-code; level beads only")->required();
    app.add_option("--layers", layers, "A:B");
    app.add_option("--voxels-per-layer", counts, "List; need not be whole");
    app.add_option("--shift", shift, "Of the lattice off the layer planes, voxels");
    app.add_option("--rays", rays, "Each");
    CLI11_PARSE(app, argc, argv);
    openvdb::initialize();
    const gcode::Toolpath whole = study::readPrint(input);
    voxelize::Selection selection;
    voxelize::parseLayers(layers, selection);
    gcode::Toolpath toolpath;
    toolpath.runs = whole.runs;
    toolpath.arcs = whole.arcs;
    for (const std::uint32_t index : voxelize::selectBeads(whole, selection))
        if (whole.beads[index].z0 == whole.beads[index].z1) toolpath.beads.push_back(whole.beads[index]);
    const auto beads = test::allBeads(toolpath);
    const test::BruteForce brute(toolpath);
    fmt::print("{}: {} beads\n{:>10} {:>9} {:>12} {:>12} {:>12} {:>12} {:>9}\n", input, beads.size(), "per layer",
               "voxel mm", "mean mm", "99.9 % mm", "max mm", "max voxel", "hits");
    for (const double count : counts) {
        voxelize::LatticeRequest request;
        request.voxels_per_layer = 1;
        voxelize::Lattice lattice =
            voxelize::chooseLattice(toolpath, beads, voxelize::boundsOf(toolpath, beads), request);
        lattice.voxel_size = lattice.layer_height / count;
        lattice.origin_z += shift * lattice.voxel_size;
        const auto intersector = march::makeBrickIntersector(*voxelize::voxelize(toolpath, beads, lattice));
        const march::Box box = intersector->bounds();
        const double radius = 0.5 * glm::length(box.max - box.min);
        std::vector<double> errors(rays, -1);
        parallelFor(rays, 256, [&](std::size_t first, std::size_t last) {
            const auto tracer = intersector->makeTracer();
            for (std::size_t n = first; n != last; ++n) {
                std::mt19937_64 random(n);
                std::uniform_real_distribution<double> unit(0, 1);
                std::normal_distribution<double> normal;
                const glm::dvec3 from = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
                const glm::dvec3 target =
                    box.min + (box.max - box.min) * glm::dvec3(unit(random), unit(random), unit(random));
                march::Hit hit;
                if (!tracer->intersect({target + from * (2 * radius), -from}, hit)) continue;
                errors[n] = std::abs(brute(hit.position.x, hit.position.y, hit.position.z));
            }
        });
        std::erase_if(errors, [](double e) { return e < 0; });
        std::sort(errors.begin(), errors.end());
        double sum = 0;
        for (const double e : errors) sum += e;
        fmt::print("{:10.3g} {:9.4f} {:12.6f} {:12.6f} {:12.6f} {:12.3f} {:9}\n", count, lattice.voxel_size,
                   sum / static_cast<double>(errors.size()), errors[errors.size() * 999 / 1000], errors.back(),
                   errors.back() / lattice.voxel_size, errors.size());
    }
    return 0;
}
