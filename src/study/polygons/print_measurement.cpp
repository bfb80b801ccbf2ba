#include "study/polygons/print_measurement.h"

#include "march/brick/brick_intersector.h"
#include "ondemand/print_field.h"
#include "shade/integrator/render.h"
#include "study/cost/own_process.h"
#include "study/picture/image_error.h"
#include "study/picture/thumbnail.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

namespace stratum::study {
namespace {

constexpr int kThumbnail = 6;  // pixels of the picture to one of the page, each way

struct Print {
    explicit Print(const std::string& path)
        : toolpath(std::make_shared<const gcode::Toolpath>(readPrint(path))),
          beads(voxelize::selectBeads(*toolpath, {})) {}

    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::vector<std::uint32_t> beads;
};

struct Held {
    Traced traced;
    std::shared_ptr<ondemand::PrintField> field;  // of a level set on demand
    Times convert, build;
    double enclosed_cm3 = 0;
};

voxelize::VoxelizeOptions culled() {
    voxelize::VoxelizeOptions options;
    options.interior = voxelize::Interior::cull;
    return options;
}

Held hold(const Representation& r, const Print& print, const PeerTracers& peers, bool measure_volume = false) {
    Held held;
    if (r.per_layer == 0) {
        held.build = timesOf([&] { held.traced = peers.beads(*print.toolpath, r.corners, r.split); });
        return held;
    }
    const voxelize::Lattice lattice = latticeOf(*print.toolpath, print.beads, r.per_layer);
    if (r.on_demand) {
        held.convert = timesOf([&] {
            held.field = std::make_shared<ondemand::PrintField>(print.toolpath, print.beads, lattice,
                                                                voxelize::Placement(), r.name);
            held.traced.intersector = march::makeBrickIntersector(std::shared_ptr<const march::LeafField>(held.field));
        });
        return held;
    }
    openvdb::FloatGrid::Ptr grid;
    held.convert = timesOf([&] { grid = voxelize::voxelize(*print.toolpath, print.beads, lattice, culled()); });
    held.build = timesOf([&] { held.traced.intersector = march::makeBrickIntersector(*grid); });
    held.traced.primitives = static_cast<std::size_t>(grid->activeVoxelCount());
    if (measure_volume) held.enclosed_cm3 = voxelize::enclosedVolume(*grid) * 1e-3;
    return held;
}

// Where the print stands is found by rays from below, which a level set on demand makes bricks for.
void settle(Held& held) {
    const Times rays = timesOf([&] { shade::restingHeight(*held.traced.intersector); });
    held.build.wall += rays.wall;
    held.build.cpu += rays.cpu;
}

// The same camera, bed and light for all ways to hold a print.
shade::SceneDescription sceneOf(const Print& print, const trace::Intersector& held, const Shot& shot) {
    const voxelize::Bounds b = voxelize::boundsOf(*print.toolpath, print.beads);
    const shade::Camera camera = shade::Camera::make(
        {}, {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}}, shot.width, shot.height);
    shade::SceneOptions options;
    // What looks at no light looks at no material either: none is made that would have to be tabulated.
    options.brdf = shot.light.empty() ? "lambert:1,1,1" : "pla-blue";
    options.env = shot.light.empty() ? "constant:1,1,1" : shot.light;
    options.camera.eye = camera.eye();
    options.camera.look_at = camera.eye() + camera.forward();
    shade::SceneDescription scene = shade::makeScene(options, held, shot.width, shot.height);
    if (scene.bed) scene.bed->z = b.min[2];
    return scene;
}

shade::RenderOptions optionsOf(const Shot& shot, int spp) {
    shade::RenderOptions options;
    options.width = shot.width;
    options.height = shot.height;
    options.spp = spp;
    options.integrator.name = shot.integrator;
    return options;
}

// Noise and bias of the middle of the frame, at its own resolution, beside uncut analytic beads.
Separated separate(const Print& print, const trace::Intersector& intersector, const shade::SceneDescription& scene,
                   const PeerTracers& peers, const Shot& shot) {
    const int half_width = shot.width / 20;
    const int half_height = shot.height / 20;
    shade::RenderOptions options = optionsOf(shot, kComparedSamples);
    options.crop = shade::PixelBox{shot.width / 2 - half_width, shot.height / 2 - half_height,
                                   shot.width / 2 + half_width, shot.height / 2 + half_height};
    const Held exact = hold({"", 0, 0, 0}, print, peers);
    const auto film = [&](const trace::Intersector& of, std::uint32_t seed) {
        options.seed = seed;
        return shade::render(of, scene, options).film;
    };
    return separateNoise(film(intersector, 1), film(intersector, 2), film(*exact.traced.intersector, 3),
                         film(*exact.traced.intersector, 4));
}

}  // namespace

Times firstLook(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot) {
    openvdb::initialize();
    const Print print(path);
    Held held = hold(r, print, peers);
    settle(held);
    const shade::SceneDescription scene = sceneOf(print, *held.traced.intersector, shot);
    const Times look = timesOf([&] { shade::render(*held.traced.intersector, scene, optionsOf(shot, 1)); });
    return {held.convert.wall + held.build.wall + look.wall, held.convert.cpu + held.build.cpu + look.cpu};
}

Row measurePrint(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot,
                 const Times& first_look) {
    openvdb::initialize();
    std::optional<Print> read;
    const Times parse = timesOf([&] { read.emplace(path); });
    const Print& print = *read;
    Held held = hold(r, print, peers);
    settle(held);
    const shade::SceneDescription scene = sceneOf(print, *held.traced.intersector, shot);
    shade::RenderResult result;
    Times render = timesOf([&] { result = shade::render(*held.traced.intersector, scene, optionsOf(shot, shot.spp)); });
    if (held.field) {
        // Bricks are made while the picture is: what it takes more than the same picture again, told from fewer
        // samples. The sum of both stays what the first one took.
        held.traced.primitives = held.field->leavesMade() * 512;
        const int fewer = std::max(1, shot.spp / 4);
        const Times again = timesOf([&] { shade::render(*held.traced.intersector, scene, optionsOf(shot, fewer)); });
        const double times = static_cast<double>(shot.spp) / fewer;
        const Times making{std::max(0.0, render.wall - times * again.wall),
                           std::max(0.0, render.cpu - times * again.cpu)};
        held.build = {held.build.wall + making.wall, held.build.cpu + making.cpu};
        render = {render.wall - making.wall, render.cpu - making.cpu};
    }
    const auto peak = static_cast<double>(peakSoFar());
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const Separated apart =
        peers.beads ? separate(print, *held.traced.intersector, scene, peers, shot) : Separated{kNone, kNone};
    const bool whole = r.per_layer > 0 && !r.on_demand;
    return joined(
        figures({voxelize::depositedVolume(*print.toolpath, print.beads) * 1e-3,
                 whole ? hold(r, print, peers, true).enclosed_cm3 : kNone, static_cast<double>(held.traced.primitives),
                 static_cast<double>(held.traced.intersector->bytes()), peak, parse.cpu, held.convert.cpu,
                 held.build.cpu, render.cpu, first_look.cpu, held.convert.wall, held.build.wall, render.wall,
                 first_look.wall, static_cast<double>(result.rays.total()), apart.noise, apart.bias}),
        {r.per_layer > 0 ? jpegOf(result.film, kThumbnail) : ""});
}

}  // namespace stratum::study
