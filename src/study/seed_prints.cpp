#include "io/error.h"
#include "march/brick_intersector.h"
#include "ondemand/print_field.h"
#include "shade/picture.h"
#include "shade/render.h"
#include "study/image_error.h"
#include "study/own_process.h"
#include "study/print.h"
#include "study/seed_print_rows.h"
#include "study/seeds.h"
#include "study/times.h"
#include "voxelize/enclosed_volume.h"
#include "voxelize/selection.h"
#include "voxelize/voxelizer.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print",          "sha256",       "light",        "size",       "spp",
                   "representation", "extruded_cm3", "enclosed_cm3", "primitives", "bytes",
                   "peak_rss_bytes", "read_cpu",     "convert_cpu",  "build_cpu",  "render_cpu",
                   "convert_wall",   "build_wall",   "render_wall",  "rays",       "noise",
                   "bias",           "series_cpu"};
constexpr std::size_t kKeys = 6;

constexpr const char* kFineLevelSet = "level set, 4 a layer";

// A way to hold a print for rays. Another way is another entry of representations().
struct Representation {
    std::string name;
    int per_layer = 0;  // of a level set, voxels a layer; 0: none
    int corners = 0;    // of prisms; 0: beads as they are
    double split = 0;
    bool on_demand = false;  // of a level set: bricks are made when rays come to them
};

std::vector<Representation> representations() {
    return {{kLevelSet, 2},
            {kFineLevelSet, 4},
            {"level set on demand", 2, 0, 0, true},
            {"level set on demand, 4 a layer", 4, 0, 0, true},
            {"beads, 8:1", 0, 0, 8},
            {"4-gons, 8:1", 0, 4, 8}};
}

// Of one print a class only: more of the same.
std::vector<Representation> finerPrisms() { return {{"6-gons, 8:1", 0, 6, 8}, {"10-gons, 8:1", 0, 10, 8}}; }

std::vector<Representation> splits() {
    std::vector<Representation> all;
    for (const int corners : {0, 4})
        for (const double split : {2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 0.0})
            all.push_back({fmt::format("{}, {}", corners == 0 ? "beads" : "4-gons",
                                       split > 0 ? fmt::format("{:g}:1", split) : "whole"),
                           0, corners, split});
    return all;
}

// How a picture is taken.
struct Shot {
    int width = 1280, height = 960, spp = 32;
    std::string light = "studio";
    bool compare = true;  // noise, bias and the series as well
};

struct Print {
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

Held hold(const Representation& r, const Print& print, const SeedPeers& peers, bool measure_volume) {
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

// CPU seconds to have the print ready for rays at 25, 50, 75 and 100 % of its volume.
double seriesSeconds(const Representation& r, const Print& print, const SeedPeers& peers) {
    const auto steps = voxelize::parseSnapshots("25%,50%,75%,100%", *print.toolpath);
    if (r.on_demand)
        return timesOf([&] {
                   const Held held = hold(r, print, peers, false);
                   for (const voxelize::Snapshot& step : steps)
                       held.field->printUntil(static_cast<std::uint32_t>(step.bead_count));
               })
            .cpu;
    if (r.per_layer > 0) {
        const voxelize::Lattice lattice = latticeOf(*print.toolpath, print.beads, r.per_layer);
        return timesOf([&] {
                   voxelize::Voxelizer voxelizer(*print.toolpath, print.beads, lattice, culled());
                   for (const voxelize::Snapshot& step : steps)
                       march::makeBrickIntersector(*voxelizer.printUntil(static_cast<std::uint32_t>(step.bead_count)));
               })
            .cpu;
    }
    double sum = 0;
    for (const voxelize::Snapshot& step : steps) {
        gcode::Toolpath part = *print.toolpath;
        part.beads.resize(step.bead_count);
        sum += timesOf([&] { peers.beads(part, r.corners, r.split); }).cpu;
    }
    return sum;
}

// The same camera, bed and light for all ways to hold a print.
shade::SceneDescription sceneOf(const Print& print, const march::Intersector& held, const Shot& shot) {
    const voxelize::Bounds b = voxelize::boundsOf(*print.toolpath, print.beads);
    const shade::Camera camera = shade::Camera::make(
        {}, {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}}, shot.width, shot.height);
    shade::SceneOptions options;
    options.brdf = "pla-blue";
    options.env = shot.light;
    options.camera.eye = camera.eye();
    options.camera.look_at = camera.eye() + camera.forward();
    shade::SceneDescription scene = shade::makeScene(options, held, shot.width, shot.height);
    if (scene.bed) scene.bed->z = b.min[2];
    return scene;
}

// In the child: the cells after the key.
std::string measure(const std::string& path, const Representation& r, const SeedPeers& peers, const Shot& shot,
                    int threads, const fs::path& picture) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
    openvdb::initialize();
    Print print;
    const Times read = timesOf([&] {
        print.toolpath = std::make_shared<const gcode::Toolpath>(readPrint(path));
        print.beads = voxelize::selectBeads(*print.toolpath, {});
    });
    Held held = hold(r, print, peers, false);
    const auto scene = sceneOf(print, *held.traced.intersector, shot);
    shade::RenderOptions options;
    options.width = shot.width;
    options.height = shot.height;
    options.spp = shot.spp;
    shade::RenderResult result;
    if (held.field) {
        // What a first look takes more than the same look again is the making of its bricks.
        options.spp = 1;
        const auto look = [&] { shade::render(*held.traced.intersector, scene, options); };
        const Times first = timesOf(look);
        const Times again = timesOf(look);
        held.build = {std::max(0.0, first.wall - again.wall), std::max(0.0, first.cpu - again.cpu)};
        options.spp = shot.spp;
    }
    const Times render = timesOf([&] { result = shade::render(*held.traced.intersector, scene, options); });
    if (held.field) held.traced.primitives = held.field->leavesMade() * 512;
    const std::size_t peak = peakSoFar();
    const std::size_t bytes = held.traced.intersector->bytes();
    if (!picture.empty()) {
        // A quarter of its size, by the mean of 4 x 4 pixels.
        const int width = shot.width / 4;
        const int height = shot.height / 4;
        shade::Film small(width, height, {0, 0, width, height});
        for (int y = 0; y < 4 * height; ++y)
            for (int x = 0; x < 4 * width; ++x) {
                small.at(x / 4, y / 4).rgb += result.film.at(x, y).rgb / 16.0f;
                small.at(x / 4, y / 4).alpha += result.film.at(x, y).alpha / 16.0f;
            }
        shade::PictureFile(picture).write(small, {});
    }
    std::string noise;
    std::string bias;
    std::string series;
    double enclosed = 0;
    if (shot.compare) {
        series = fmt::format("{:.4g}", seriesSeconds(r, print, peers));
        if (r.per_layer > 0 && !r.on_demand) enclosed = hold(r, print, peers, true).enclosed_cm3;
        if (peers.beads) {
            // The middle of the frame, at its own resolution.
            const int half_width = shot.width / 20;
            const int half_height = shot.height / 20;
            options.spp = kSeedSamples;
            options.crop = shade::PixelBox{shot.width / 2 - half_width, shot.height / 2 - half_height,
                                           shot.width / 2 + half_width, shot.height / 2 + half_height};
            const Held exact = hold({"", 0, 0, 0}, print, peers, false);
            const auto film = [&](const march::Intersector& intersector, std::uint32_t seed) {
                options.seed = seed;
                return shade::render(intersector, scene, options).film;
            };
            const Separated apart =
                separateNoise(film(*held.traced.intersector, 1), film(*held.traced.intersector, 2),
                              film(*exact.traced.intersector, 3), film(*exact.traced.intersector, 4));
            noise = fmt::format("{:.4g}", apart.noise);
            bias = fmt::format("{:.4g}", apart.bias);
        }
    }
    const std::string line =
        csvLine({fmt::format("{:.5g}", volumeOf(*print.toolpath, print.beads) * 1e-3),
                 enclosed > 0 ? fmt::format("{:.5g}", enclosed) : "", std::to_string(held.traced.primitives),
                 std::to_string(bytes), std::to_string(peak), fmt::format("{:.4g}", read.cpu),
                 fmt::format("{:.4g}", held.convert.cpu), fmt::format("{:.4g}", held.build.cpu),
                 fmt::format("{:.4g}", render.cpu), fmt::format("{:.4g}", held.convert.wall),
                 fmt::format("{:.4g}", held.build.wall), fmt::format("{:.4g}", render.wall),
                 std::to_string(result.rays.total()), noise, bias, series});
    return line.substr(0, line.size() - 1);
}

}  // namespace

void studySeedPrints(const SeedsOptions& options, const SeedPeers& peers, const StudyOptions& common, Page& page,
                     StudyReport& report) {
    Shot shot;
    if (!options.environment.empty()) shot.light = options.environment;
    if (common.quick) shot.width = 64, shot.height = 48, shot.spp = 4;
    if (options.spp > 0) shot.spp = options.spp;
    Shot small = shot;
    small.width /= 4, small.height /= 4, small.spp = std::max(1, shot.spp / 4);
    small.compare = false;
    ResultTable table(common.folder / "seeds_prints.csv", kColumns, kKeys, common.fresh);
    if (!peers.beads) report.findings.emplace_back("beads and prisms (Embree) are left out: bench_vdbstudy has them");
    const std::vector<Representation> kinds = representations();
    const std::vector<Representation> ways = splits();
    const fs::path pictures = common.folder / "references";
    fs::create_directories(pictures);
    std::vector<SeedPrintResult> results;
    std::map<std::string, std::string> swept;  // class: the print whose segments are cut in all ways
    double done = 0;
    for (const std::string& path : options.prints) {
        SeedPrintResult result;
        result.name = fs::path(path).stem().string();
        result.picture = pictures / (result.name + ".png");
        const std::string hash = shortHash(path);
        const auto rowOf = [&](const Representation& r, const Shot& s) -> std::optional<Row> {
            const Row key{fs::path(path).filename().string(),
                          hash,
                          fs::path(s.light).filename().string(),
                          fmt::format("{}x{}", s.width, s.height),
                          std::to_string(s.spp),
                          r.name};
            if (table.find(key) == nullptr) {
                if (r.per_layer == 0 && !peers.beads) return std::nullopt;
                const Outcome outcome = inOwnProcess([&] {
                    return measure(path, r, peers, s, common.threads, r.per_layer > 0 ? result.picture : fs::path());
                });
                if (!outcome.failure.empty())
                    throw InputError(fmt::format("{}: {}: {}", path, r.name, outcome.failure));
                Row row = key;
                const Row cells = parseCsvLine(outcome.text);
                row.insert(row.end(), cells.begin(), cells.end());
                table.add(std::move(row));
            }
            return *table.find(key);
        };
        for (const Representation& kind : kinds)
            if (auto row = rowOf(kind, shot)) result.rows.push_back(std::move(*row));
        result.enclosed = seedValue(result.rows.front(), kEnclosed);
        const std::string size = seedClassOf(result.enclosed);
        if (swept.emplace(size, result.name).first->second == result.name) {
            for (const Representation& way : ways)
                if (auto row = rowOf(way, small)) result.sweep.push_back(std::move(*row));
            for (const Representation& kind : finerPrisms())
                if (auto row = rowOf(kind, shot)) result.rows.push_back(std::move(*row));
        }
        results.push_back(std::move(result));
        if (common.progress) common.progress(++done / static_cast<double>(options.prints.size()));
    }
    std::sort(results.begin(), results.end(),
              [](const SeedPrintResult& a, const SeedPrintResult& b) { return a.enclosed < b.enclosed; });
    page.heading("Prints: level sets, beads and prisms (\u0160pilar 2025)");
    page.paragraph(fmt::format(
        "{} prints, {}x{} pixels, path tracing with three bounces by the same code for all, a "
        "modelled measured material (pla-blue), light: {}. The level set has 2 voxels a layer where nothing else "
        "is said, and what the outside can't see is culled; on demand, its bricks are made when "
        "rays come to them, which counts as \"build\" (what a first look of one sample a pixel takes more than the "
        "same look again), and "
        "primitives are the voxels evaluated; beads are analytic, cut where they are longer than eight "
        "widths; n-gons are prisms of n "
        "sides, cut likewise; both are traced by Embree, in packets of 16 where rays run side by side. Times are CPU "
        "seconds of all threads; pictures were rendered with {} samples a pixel, and their time is told for {} in "
        "proportion; \"convert\" is from beads to level set, \"build\" what rays need besides. Noise is "
        "the relMSE of this picture against its limit, bias that of its limit against the limit of the uncut analytic "
        "beads, from two pictures each of the middle of the frame (see src/study/image_error.h); a bias around or "
        "below "
        "zero is less than can be measured. \"Series\" is CPU time until the print at 25, 50, 75 and 100 % is ready "
        "for rays, pictures not counted.",
        results.size(), shot.width, shot.height, fs::path(shot.light).filename().string(), shot.spp, kSeedSamples));
    for (const SeedPrintResult& r : results)
        if (fs::exists(r.picture)) page.picture(r.picture, r.name);
    std::vector<std::string> names;
    names.reserve(kinds.size());
    for (const Representation& kind : kinds) names.push_back(kind.name);
    addSeedPrints(page, results, names, report);
    report.rows += table.rows().size();
    report.resumed += table.resumed();
}

}  // namespace stratum::study
