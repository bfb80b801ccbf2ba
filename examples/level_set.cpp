// G-code -> level set -> one ray from above -> a material, through every library.
#include <gcode/container/container.h>
#include <gcode/reader.h>
#include <march/brick/brick_intersector.h>
#include <shade/finish/named_brdf.h>
#include <voxelize/beads/lattice.h>
#include <voxelize/beads/selection.h>
#include <voxelize/grid/voxelizer.h>

#include <cstdio>

using namespace stratum;

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: level_set PRINT.gcode\n"), 2;
    openvdb::initialize();
    const gcode::InputBytes file(argv[1]);
    const gcode::Toolpath toolpath = gcode::readToolpath(file.bytes(), file.name(), {});
    const auto beads = voxelize::selectBeads(toolpath, {});
    const voxelize::Bounds bounds = voxelize::boundsOf(toolpath, beads);
    const voxelize::Lattice lattice = voxelize::chooseLattice(toolpath, beads, bounds, {});
    voxelize::Voxelizer voxelizer(toolpath, beads, lattice, {});
    const auto grid = voxelizer.printUntil(static_cast<std::uint32_t>(toolpath.beads.size()));
    const auto scene = march::makeBrickIntersector(*grid);
    const trace::Box box = scene->bounds();
    trace::Ray ray;
    ray.origin = {(box.min.x + box.max.x) / 2 + 0.013, (box.min.y + box.max.y) / 2 + 0.017, box.max.z + 1};
    ray.direction = {0, 0, -1};
    trace::Hit hit;
    const bool met = scene->makeTracer()->intersect(ray, hit);
    const bool material = shade::makeBrdf("lambert:0.5,0.5,0.5") != nullptr;
    std::printf("%zu %llu %d %d\n", toolpath.beads.size(), static_cast<unsigned long long>(grid->activeVoxelCount()),
                met && hit.position.z > box.min.z && hit.position.z < box.max.z, material);
}
