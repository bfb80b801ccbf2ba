// Whether culling shows: the same rays through a kept and a culled grid of one print.
//
// Views all around it, views from beside the surface (which look into whatever is concave), and cosine rays from every
// hit, as ambient occlusion has them. Counts rays that end elsewhere and says where.
#include "base/parallel_for.h"
#include "march/brick/brick_intersector.h"
#include "study/cost/times.h"
#include "study/print.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <mutex>
#include <numbers>
#include <random>

namespace {

using namespace stratum;

struct Tally {
    std::size_t rays = 0, hits = 0, secondary = 0;
    std::size_t other_hit = 0, other_normal = 0, other_occlusion = 0;
    double farthest = 0;  // mm between two hits of one ray
    glm::dvec3 where{0.0};

    void add(const Tally& t) {
        rays += t.rays, hits += t.hits, secondary += t.secondary;
        other_hit += t.other_hit, other_normal += t.other_normal, other_occlusion += t.other_occlusion;
        if (t.farthest > farthest) farthest = t.farthest, where = t.where;
    }
};

glm::dvec3 onSphere(double a, double b) {
    const double z = 1 - 2 * a;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(2 * std::numbers::pi * b), r * std::sin(2 * std::numbers::pi * b), z};
}

// Compares one ray; `normal` and `from` are of the kept grid's hit.
bool compare(trace::Tracer& kept, trace::Tracer& culled, const trace::Ray& ray, Tally& tally, trace::Hit& hit) {
    trace::Hit other;
    const bool a = kept.intersect(ray, hit);
    const bool b = culled.intersect(ray, other);
    ++tally.rays;
    if (a != b || (a && hit.t != other.t)) {
        ++tally.other_hit;
        const double apart = a && b ? std::abs(hit.t - other.t) : 1e9;
        if (apart > tally.farthest) tally.farthest = apart, tally.where = a ? hit.position : other.position;
    } else if (a && hit.normal != other.normal) {
        ++tally.other_normal;
    }
    tally.hits += a ? 1 : 0;
    return a && b && hit.t == other.t;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Counts rays that see a difference between a kept and a culled grid");
    std::string input;
    double voxel = 0.1;
    int views = 64;
    int size = 512;
    int cosine_rays = 2;
    double percent = 100;
    app.add_option("input", input, "G-code")->required();
    app.add_option("--voxel-size", voxel, "mm");
    app.add_option("--views", views, "Half around the part, half from beside its surface");
    app.add_option("--size", size, "Rays along the edge of a view");
    app.add_option("--cosine-rays", cosine_rays, "From every hit");
    app.add_option("--percent", percent, "Of the beads: a print stopped half way is open on top");
    CLI11_PARSE(app, argc, argv);
    openvdb::initialize();

    const gcode::Toolpath toolpath = study::readPrint(input);
    std::vector<std::uint32_t> beads = voxelize::selectBeads(toolpath, {});
    beads.resize(static_cast<std::size_t>(static_cast<double>(beads.size()) * percent / 100));
    const auto lattice = study::latticeOf(toolpath, beads, voxel);
    std::unique_ptr<trace::Intersector> intersectors[2];
    for (int cull = 0; cull < 2; ++cull) {
        voxelize::VoxelizeOptions options;
        options.interior = cull != 0 ? voxelize::Interior::cull : voxelize::Interior::keep;
        const auto grid = voxelize::voxelize(toolpath, beads, lattice, options);
        fmt::print("{}: {} active voxels, {} leaves\n", cull != 0 ? "cull" : "keep", grid->activeVoxelCount(),
                   grid->tree().leafCount());
        intersectors[cull] = march::makeBrickIntersector(*grid);
    }
    const trace::Box box = intersectors[0]->bounds();
    const glm::dvec3 center = 0.5 * (box.min + box.max);
    const double radius = 0.5 * glm::length(box.max - box.min);
    const double offset = intersectors[0]->surfaceOffset();

    Tally around;
    Tally beside;
    Tally cosine;
    std::mutex mutex;
    for (int view = 0; view < views; ++view) {
        const bool outer = view < views / 2;
        const int n = outer ? view : view - views / 2;
        // Evenly over the sphere, straight up and straight down included.
        const int directions = std::max(views / 2, 2);
        const glm::dvec3 from = onSphere(static_cast<double>(n) / (directions - 1), n * 0.6180339887498949);
        const glm::dvec3 side =
            glm::normalize(glm::cross(std::abs(from.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0), from));
        const glm::dvec3 up = glm::cross(from, side);
        // Beside the surface: a millimetre off where the ray to the middle meets it, looking everywhere.
        glm::dvec3 eye{0.0};
        if (!outer) {
            trace::Hit hit;
            if (!intersectors[0]->makeTracer()->intersect({center + from * (2 * radius), -from}, hit)) continue;
            eye = hit.position + hit.normal;
        }
        parallelFor(static_cast<std::size_t>(size), 8, [&](std::size_t first, std::size_t last) {
            const auto kept = intersectors[0]->makeTracer();
            const auto culled = intersectors[1]->makeTracer();
            Tally direct;
            Tally bounced;
            for (std::size_t row = first; row != last; ++row) {
                std::mt19937_64 random(static_cast<std::uint64_t>(view) << 32 | row);
                std::uniform_real_distribution<double> unit(0, 1);
                for (int x = 0; x < size; ++x) {
                    const double u = (x + unit(random)) / size;
                    const double v = (static_cast<double>(row) + unit(random)) / size;
                    trace::Ray ray;
                    if (outer) {
                        ray.origin =
                            center + from * (2 * radius) + (2 * u - 1) * radius * side + (2 * v - 1) * radius * up;
                        ray.direction = -from;
                    } else {
                        ray.origin = eye;
                        ray.direction = onSphere(u, v);
                    }
                    trace::Hit hit;
                    if (!compare(*kept, *culled, ray, direct, hit)) continue;
                    for (int s = 0; s < cosine_rays; ++s) {
                        trace::Ray bounce;
                        bounce.direction =
                            glm::normalize(hit.normal + onSphere(unit(random), unit(random)) * (1 - 1e-9));
                        bounce.origin = hit.position + hit.normal * offset;
                        trace::Hit unused;
                        compare(*kept, *culled, bounce, bounced, unused);
                    }
                }
            }
            const std::scoped_lock lock(mutex);
            (outer ? around : beside).add(direct);
            cosine.add(bounced);
        });
    }
    for (const auto& [name, tally] : {std::pair{"around", around}, {"beside", beside}, {"cosine", cosine}})
        fmt::print("{:8} {:>11} rays, {:>11} hits: {} end elsewhere, {} have another normal{}\n", name, tally.rays,
                   tally.hits, tally.other_hit, tally.other_normal,
                   tally.farthest > 0 ? fmt::format("; farthest {:.3g} mm at {:.2f} {:.2f} {:.2f}", tally.farthest,
                                                    tally.where.x, tally.where.y, tally.where.z)
                                      : "");
    return 0;
}
