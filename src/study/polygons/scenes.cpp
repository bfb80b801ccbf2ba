#include "assemble/scene_file.h"
#include "march/brick/brick_intersector.h"
#include "march/file/sdf_grid.h"
#include "march/reference/sphere_intersector.h"
#include "study/cost/times.h"
#include "study/picture/image_error.h"
#include "study/picture/thumbnail.h"
#include "study/polygons/mesh_intersector.h"
#include "study/polygons/polygons.h"
#include "study/print.h"
#include "trace/scene_intersector.h"
#include "trace/sdf_intersector.h"

#include "base/error.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"scene", "sha256",        "size",        "representation", "frame", "primitives",
                   "bytes", "build_seconds", "cpu_seconds", "wall_seconds",   "rays",  "off_share"};
constexpr std::size_t kKeys = 5;
constexpr std::size_t kPrimitives = 5, kBytes = 6, kBuild = 7, kCpu = 8, kRays = 10, kOff = 11;

constexpr double kVoxel = 0.02;    // scene units; a pixel is 0.01 wide at a distance of 10
constexpr double kVisible = 0.02;  // of the scale from black to white, in a channel
constexpr double kSlow = 20;       // CPU seconds a frame
constexpr int kSlowFrames = 2;
constexpr int kThumbnail = 4;  // pixels of a picture to one of the page, each way
constexpr const char* kExact = "SDF, by formula";
constexpr const char* kLevelSet = "level set, brick";

struct Representation {
    std::string name;
    bool polygons = false;
    bool accelerated = true;
    std::function<Traced()> make;
};

std::vector<Representation> representationsOf(const std::string& file, const assemble::SceneFile& scene,
                                              const PeerTracers& peers, bool quick) {
    using trace::SceneObject;
    const auto together = [&scene](const auto& shapeOf) {
        std::vector<SceneObject> objects;
        for (const assemble::ObjectOptions& object : scene.objects)
            objects.push_back({shapeOf(object), object.placement});
        return objects;
    };
    const std::size_t count = scene.objects.size();
    // One owner for what makeSceneIntersector() shares.
    class Held final : public trace::Intersector {
    public:
        explicit Held(std::shared_ptr<const trace::Intersector> held) : held_(std::move(held)) {}
        std::unique_ptr<trace::Tracer> makeTracer() const override { return held_->makeTracer(); }
        std::string_view name() const override { return held_->name(); }
        trace::Box bounds() const override { return held_->bounds(); }
        double voxelSize() const override { return held_->voxelSize(); }
        std::size_t bytes() const override { return held_->bytes(); }
        double surfaceOffset() const override { return held_->surfaceOffset(); }

    private:
        std::shared_ptr<const trace::Intersector> held_;
    };
    const auto traced = [count](std::vector<SceneObject> objects) {
        return Traced{std::make_unique<Held>(trace::makeSceneIntersector(std::move(objects))), count};
    };
    const double voxel = quick ? 5 * kVoxel : kVoxel;
    std::vector<Representation> all;
    all.push_back({kExact, false, true, [=] {
                       return traced(together([](const assemble::ObjectOptions& o) {
                           return std::shared_ptr<const trace::Intersector>(trace::makeSdfIntersector(o.sdf));
                       }));
                   }});
    all.push_back({kLevelSet, false, true, [=] {
                       return traced(together([voxel](const assemble::ObjectOptions& o) {
                           return std::shared_ptr<const trace::Intersector>(
                               march::makeBrickIntersector(*march::makeSdfGrid(*o.sdf, voxel)));
                       }));
                   }});
    all.push_back({"level set, sphere traced", false, true, [=] {
                       return traced(together([voxel](const assemble::ObjectOptions& o) {
                           return std::shared_ptr<const trace::Intersector>(
                               march::makeSphereIntersector(march::makeSdfGrid(*o.sdf, voxel)));
                       }));
                   }});
    struct Detail {
        const char* name;
        int rings, points;
    };
    std::size_t known = 0;
    for (const Detail& detail : {Detail{"low mesh", 7, 10}, {"high mesh", 14, 50}, {"fine mesh", 256, 1024}}) {
        const TriangleMesh mesh = sceneMesh(file, detail.rings, detail.points);
        if (mesh.triangles.size() == known) break;  // boxes have no detail
        known = mesh.triangles.size();
        if (detail.rings < 100)
            all.push_back({fmt::format("{}, every triangle", detail.name), true, false, [mesh] {
                               return Traced{makeMeshIntersector(mesh), mesh.triangles.size()};
                           }});
        all.push_back({fmt::format("{}, Embree", detail.name), true, true,
                       peers.mesh ? [mesh, peers] { return peers.mesh(mesh); } : std::function<Traced()>()});
    }
    return all;
}

shade::SceneDescription describe(const assemble::SceneFile& file, const trace::Intersector& shape, int width,
                                 int height) {
    shade::SceneDescription scene = shade::makeScene(file.scene, shape, width, height);
    for (const assemble::ObjectOptions& object : file.objects)
        scene.objects.emplace_back(
            shade::makeBrdf(object.material.brdf.empty() ? file.scene.brdf : object.material.brdf));
    return scene;
}

double offShare(const DisplayPicture& a, const DisplayPicture& b) {
    std::size_t off = 0;
    for (std::size_t n = 0; n < a.pixels.size(); ++n)
        for (int c = 0; c < 3; ++c)
            if (std::abs(static_cast<double>(a.pixels[n][c] - b.pixels[n][c])) > kVisible) {
                ++off;
                break;
            }
    return static_cast<double>(off) / static_cast<double>(a.pixels.size());
}

struct Summary {
    double mean = 0, deviation = 0;  // CPU seconds a frame
    double off = 0, primitives = 0, bytes = 0, build = 0, rays = 0;
    int frames = 0;
    std::string run;
    std::size_t line = 0;  // of polygons_scenes.csv, the first frame's
};

Summary summaryOf(const std::vector<const Row*>& rows, const ResultTable& table) {
    Summary s;
    s.run = rows.front()->back();
    s.line = table.lineOf(*rows.front());
    s.frames = static_cast<int>(rows.size());
    for (const Row* row : rows) s.mean += numberIn(*row, kCpu) / s.frames;
    for (const Row* row : rows) s.deviation += std::pow(numberIn(*row, kCpu) - s.mean, 2);
    s.deviation = s.frames > 1 ? std::sqrt(s.deviation / (s.frames - 1)) : 0;
    s.off = numberIn(*rows.front(), kOff);
    s.primitives = numberIn(*rows.front(), kPrimitives);
    s.bytes = numberIn(*rows.front(), kBytes);
    s.build = numberIn(*rows.front(), kBuild);
    s.rays = numberIn(*rows.front(), kRays);
    return s;
}

// Everything of one scene, in its representations' order.
struct SceneResult {
    std::string name;
    std::vector<std::pair<Representation, Summary>> all;
    fs::path picture;

    const Summary* find(const char* wanted) const {
        for (const auto& [r, s] : all)
            if (r.name == wanted) return &s;
        return nullptr;
    }
};

SceneResult measureScene(const std::string& path, const PeerTracers& peers, int frames, ResultTable& table,
                         const StudyOptions& common, const std::function<void(double)>& progress) {
    assemble::SceneFile file = assemble::readSceneFile(path);
    if (file.objects.empty()) throw InputError(fmt::format("{}: has no objects", path));
    if (common.quick) {
        file.render.width /= 10;
        file.render.height /= 10;
    }
    const int width = file.render.width;
    const int height = file.render.height;
    SceneResult result;
    result.name = fs::path(path).stem().string();
    result.picture = common.folder / "references" / (result.name + "_small.jpg");
    const Row head{fs::path(path).filename().string(), shortHash(path), fmt::format("{}x{}", width, height)};
    struct Ready {
        Traced traced;
        std::optional<shade::SceneDescription> scene;
        double build = 0, off = 0;
    };
    const std::vector<Representation> all = representationsOf(path, file, peers, common.quick);
    std::vector<std::optional<Ready>> ready(all.size());
    std::optional<DisplayPicture> exact;
    const auto exactPicture = [&]() -> const DisplayPicture& {
        if (exact) return *exact;
        const Traced traced = all.front().make();
        const auto scene = describe(file, *traced.intersector, width, height);
        const shade::Film film = shade::render(*traced.intersector, scene, file.render).film;
        fs::create_directories(common.folder / "references");
        writeThumbnail(result.picture, film, kThumbnail);
        exact = displayed(film);
        return *exact;
    };
    std::vector<double> last(all.size(), 0);  // CPU seconds of the last frame
    // Frames outermost: what disturbs the machine for a while disturbs all.
    for (int frame = 1; frame <= frames; ++frame) {
        for (std::size_t n = 0; n < all.size(); ++n) {
            Row key = head;
            key.insert(key.end(), {all[n].name, std::to_string(frame)});
            // A frame of minutes is repeated less often.
            if (frame > kSlowFrames && last[n] > kSlow) continue;
            if (table.find(key) == nullptr && all[n].make) {
                if (!ready[n]) {
                    Ready now;
                    now.build = timesOf([&] { now.traced = all[n].make(); }).cpu;
                    now.scene = describe(file, *now.traced.intersector, width, height);
                    // Also warms the caches.
                    now.off = offShare(exactPicture(),
                                       displayed(shade::render(*now.traced.intersector, *now.scene, file.render).film));
                    ready[n] = std::move(now);
                }
                std::uint64_t rays = 0;
                const Times times = timesOf([&] {
                    rays = shade::render(*ready[n]->traced.intersector, *ready[n]->scene, file.render).rays.total();
                });
                Row row = key;
                row.insert(
                    row.end(),
                    {std::to_string(ready[n]->traced.primitives), std::to_string(ready[n]->traced.intersector->bytes()),
                     fmt::format("{:.4g}", ready[n]->build), fmt::format("{:.5g}", times.cpu),
                     fmt::format("{:.5g}", times.wall), std::to_string(rays), fmt::format("{:.5g}", ready[n]->off)});
                table.add(std::move(row));
            }
            if (const Row* row = table.find(key)) last[n] = numberIn(*row, kCpu);
        }
        if (progress) progress(static_cast<double>(frame) / frames);
    }
    for (std::size_t n = 0; n < all.size(); ++n) {
        std::vector<const Row*> found;
        for (int frame = 1; frame <= frames; ++frame) {
            Row key = head;
            key.insert(key.end(), {all[n].name, std::to_string(frame)});
            if (const Row* row = table.find(key)) found.push_back(row);
        }
        if (!found.empty()) result.all.emplace_back(all[n], summaryOf(found, table));
    }
    if (!fs::exists(result.picture)) exactPicture();
    return result;
}

void addTable(Page& page, const std::vector<SceneResult>& results) {
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const SceneResult& r : results) {
        const Summary* exact = r.find(kExact);
        for (const auto& [representation, s] : r.all) {
            lines.push_back(s.line);
            cells.push_back({r.name, representation.name, fmt::format("{:.0f}", s.primitives),
                             fmt::format("{:.2f}", s.bytes * 1e-6), fmt::format("{:.1f}", s.build * 1e3),
                             fmt::format("{:.1f}", s.mean * 1e3), fmt::format("{:.1f}", s.deviation * 1e3),
                             std::to_string(s.frames), fmt::format("{:.2f}", s.rays / s.mean * 1e-6),
                             exact != nullptr ? fmt::format("{:.2f}", s.mean / exact->mean) : "-",
                             fmt::format("{:.2f}", s.off * 100), s.run});
        }
    }
    page.table({"scene", "as", "primitives", "MB", "build ms", "ms a frame", "\u00b1 ms", "frames", "Mrays/s",
                "of the formula's time", "pixels off %", "run"},
               cells, {}, lines, "polygons_scenes");
}

// How often one is faster than another, and the geometric mean of how much.
struct Contest {
    int scenes = 0, won = 0;
    double logs = 0;
    void add(const Summary* own, const Summary* other) {
        if (own == nullptr || other == nullptr) return;
        ++scenes;
        won += own->mean < other->mean ? 1 : 0;
        logs += std::log(other->mean / own->mean);
    }
    std::string text() const {
        return fmt::format("in {} of {} scenes, {:.2f} times as fast on (geometric) average", won, scenes,
                           std::exp(logs / std::max(scenes, 1)));
    }
};

// The plain answer, from the figures.
void addAnswer(Page& page, const std::vector<SceneResult>& results) {
    Contest plain;     // formula, every triangle
    Contest tree;      // formula, Embree, low mesh
    Contest fine;      // formula, Embree, fine mesh
    Contest set_low;   // level set, Embree
    Contest set_fine;  // level set, Embree, fine mesh
    Contest gain;      // Embree, every triangle
    for (const SceneResult& r : results) {
        const Summary* formula = r.find(kExact);
        const Summary* level_set = r.find(kLevelSet);
        const Summary* low = r.find("low mesh, Embree");
        // Of boxes alone the low mesh is the fine one.
        const Summary* most = r.find("fine mesh, Embree") != nullptr ? r.find("fine mesh, Embree") : low;
        plain.add(formula, r.find("low mesh, every triangle"));
        tree.add(formula, low);
        fine.add(formula, most);
        set_low.add(level_set, low);
        set_fine.add(level_set, most);
        gain.add(low, r.find("low mesh, every triangle"));
    }
    page.heading("When is marching better than polygons?");
    page.paragraph(fmt::format(
        "Against every triangle in turn, as the thesis did it, marching the formula is faster {}, with the coarser "
        "meshes.",
        plain.text()));
    if (tree.scenes == 0) {
        page.paragraph("This program has no hierarchy of triangles to compare with: bench_vdbstudy has.");
        return;
    }
    page.paragraph(fmt::format(
        "What the thesis left for the future decides it. With a hierarchy (Embree) the same coarse meshes are faster "
        "than every triangle in turn {}. Against them the formula is faster {}, and the level set {}.",
        gain.text(), tree.text(), set_low.text()));
    page.paragraph(fmt::format(
        "Coarse meshes are also wrong: see the pixels that are off. Against meshes fine enough to look round, the "
        "formula is faster {}, the level set {}.",
        fine.text(), set_fine.text()));
    const bool few = 2 * tree.won <= tree.scenes;
    const bool round = 2 * set_fine.won > set_fine.scenes;
    page.paragraph(fmt::format(
        "So: a handful of simple shapes is {} for polygons with a hierarchy, {}. A formula takes no memory and is "
        "exact "
        "at any distance, but its cost grows with the number of shapes, which a hierarchy's hardly does; a level set's "
        "cost does not depend on how its shape is described, only on the voxels that rays pass. Marching is better "
        "where "
        "shapes are round and must look round, where they are unions of thousands, or where no mesh exists.",
        few ? "a case" : "no case",
        round ? "unless they must look round: then the level set is the faster one"
              : "even when they must look round"));
}

}  // namespace

std::unique_ptr<ResultTable> studyScenes(const PolygonsOptions& options, const PeerTracers& peers,
                                         const StudyOptions& common, Page& page, StudyReport& report) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const int frames = options.frames > 0 ? options.frames : common.quick ? 2 : 10;
    auto table = std::make_unique<ResultTable>(common, "polygons_scenes.csv", kColumns, kKeys);
    if (!peers.mesh)
        report.findings.emplace_back("meshes with a hierarchy (Embree) are left out: bench_vdbstudy has them");
    std::vector<SceneResult> results;
    const auto count = static_cast<double>(options.scenes.size());
    for (std::size_t n = 0; n < options.scenes.size(); ++n)
        results.push_back(measureScene(options.scenes[n], peers, frames, *table, common, [&](double share) {
            if (common.progress) common.progress((static_cast<double>(n) + share) / count);
        }));
    page.heading("Shapes: signed distances and polygons (Roukema 2023)");
    page.paragraph(fmt::format(
        "One core, one ray a pixel, Phong's shading with hard shadows and mirrors to a depth of five, the same code "
        "for all; {} frames of each ({} of what takes longer than {:g} s a frame), CPU time, mean and standard "
        "deviation. A level set is of voxels of {:g}; one "
        "grid an object. \"Every triangle\" is the thesis's way: no hierarchy, back faces culled. The low mesh has "
        "spheres of 7 x 7 and cylinders of 10 points, the high one 14 x 14 and 50, the fine one 256 x 256 and 1024. "
        "Pixels are off if a channel of the displayed picture differs from the formula's by more than {:g} of the "
        "scale: with polygons, their facets. Where the thesis gives its SDF and its mesh different sizes (its box of "
        "scene 2, its sphere of scene 1), all are of the SDF's here. Times there, on another machine and with one "
        "column of pixels a display frame, are no figures to compare with; ratios between its meshes are.",
        frames, kSlowFrames, kSlow, common.quick ? 5 * kVoxel : kVoxel, kVisible));
    for (const SceneResult& r : results) page.picture(r.picture, r.name);
    Plot plot{"A frame on one core", "scene", "CPU seconds", false, true, {}};
    for (const char* name :
         {kExact, kLevelSet, "level set, sphere traced", "low mesh, every triangle", "high mesh, every triangle",
          "low mesh, Embree", "high mesh, Embree", "fine mesh, Embree"}) {
        Series series{name, {}, false, false};
        for (std::size_t n = 0; n < results.size(); ++n)
            if (const Summary* s = results[n].find(name)) {
                series.points.emplace_back(static_cast<double>(n + 1), s->mean);
                series.bars.emplace_back(s->mean - s->deviation, s->mean + s->deviation);
            }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    page.plot(plot);
    addTable(page, results);
    addAnswer(page, results);
    report.rows += table->rows().size();
    report.resumed += table->resumed();
    return table;
}

}  // namespace stratum::study
