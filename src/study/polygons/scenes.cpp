#include "assemble/scene_file.h"
#include "march/brick/brick_intersector.h"
#include "march/file/sdf_grid.h"
#include "march/reference/reference_intersectors.h"
#include "shade/finish/named_brdf.h"
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

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColumns =
    "scene,sha256,size,representation,frame,primitives,bytes,build_seconds,cpu_seconds,wall_seconds,rays,"
    "off_share";

constexpr double kVoxel = 0.02;    // scene units; a pixel is 0.01 wide at a distance of 10
constexpr double kVisible = 0.02;  // of the scale from black to white, in a channel
constexpr double kSlow = 20;       // CPU seconds a frame
constexpr int kSlowFrames = 2;
constexpr int kThumbnail = 4;  // pixels of a picture to one of the page, each way
constexpr const char* kExact = "SDF, by formula";
constexpr const char* kLevelSet = "level set, brick";

struct SceneShape {
    std::string name;
    std::function<Traced()> make;
};

std::vector<SceneShape> shapesOf(const std::string& file, const assemble::SceneFile& scene, const PeerTracers& peers,
                                 bool quick) {
    // Each object by `shapeOf` its signed distance.
    const auto together = [&scene](const auto& shapeOf) {
        return [&scene, shapeOf] {
            std::vector<trace::SceneObject> objects;
            for (const assemble::ObjectOptions& object : scene.objects)
                objects.push_back({std::shared_ptr<const trace::Intersector>(shapeOf(object.sdf)), object.placement});
            return Traced{trace::makeSceneIntersector(std::move(objects)), scene.objects.size()};
        };
    };
    const double voxel = quick ? 5 * kVoxel : kVoxel;
    std::vector<SceneShape> all{
        {kExact, together([](const auto& sdf) { return trace::makeSdfIntersector(sdf); })},
        {kLevelSet,
         together([voxel](const auto& sdf) { return march::makeBrickIntersector(*march::makeSdfGrid(*sdf, voxel)); })},
        {"level set, sphere traced",
         together([voxel](const auto& sdf) { return march::makeSphereIntersector(march::makeSdfGrid(*sdf, voxel)); })}};
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
            all.push_back({fmt::format("{}, every triangle", detail.name), [mesh] {
                               return Traced{makeMeshIntersector(mesh), mesh.triangles.size()};
                           }});
        if (peers.mesh)
            all.push_back({fmt::format("{}, Embree", detail.name), [mesh, peers] { return peers.mesh(mesh); }});
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

// CPU seconds a frame of one shape in one scene.
struct Summary {
    double mean = 0, deviation = 0;
};

// Everything of one scene.
struct SceneResult {
    std::string name;
    std::map<std::string, Summary> all;

    const Summary* find(const char* wanted) const {
        const auto found = all.find(wanted);
        return found == all.end() ? nullptr : &found->second;
    }
};

Summary summaryOf(const std::vector<double>& seconds) {
    Summary s;
    const auto frames = static_cast<double>(seconds.size());
    for (const double v : seconds) s.mean += v / frames;
    for (const double v : seconds) s.deviation += std::pow(v - s.mean, 2);
    s.deviation = frames > 1 ? std::sqrt(s.deviation / (frames - 1)) : 0;
    return s;
}

SceneResult measureScene(const std::string& path, const PeerTracers& peers, int frames, Table& table, Page& page,
                         bool quick) {
    assemble::SceneFile file = assemble::readSceneFile(path);
    if (file.objects.empty()) throw InputError(fmt::format("{}: has no objects", path));
    if (quick) {
        file.render.width /= 10;
        file.render.height /= 10;
    }
    const int width = file.render.width;
    const int height = file.render.height;
    const Row head{fs::path(path).filename().string(), shortHash(path), fmt::format("{}x{}", width, height)};
    struct Ready {
        std::string name;
        Traced traced;
        std::optional<shade::SceneDescription> scene;
        double build = 0, off = 0;
        std::vector<double> seconds;  // CPU, of each frame
    };
    SceneResult result{fs::path(path).stem().string(), {}};
    std::vector<Ready> ready;
    std::optional<DisplayPicture> exact;
    for (const SceneShape& shape : shapesOf(path, file, peers, quick)) {
        Ready now{shape.name, {}, {}, 0, 0, {}};
        now.build = timesOf([&] { now.traced = shape.make(); }).cpu;
        now.scene = describe(file, *now.traced.intersector, width, height);
        // Also warms the caches. The first is the formula itself.
        const shade::Film film = shade::render(*now.traced.intersector, *now.scene, file.render).film;
        if (!exact) {
            page.picture(jpegOf(film, kThumbnail), result.name);
            exact = displayed(film);
        }
        now.off = offShare(*exact, displayed(film));
        ready.push_back(std::move(now));
    }
    // Frames outermost: what disturbs the machine for a while disturbs all.
    for (int frame = 1; frame <= frames; ++frame)
        for (Ready& r : ready) {
            // A frame of minutes is repeated less often.
            if (frame > kSlowFrames && r.seconds.back() > kSlow) continue;
            std::uint64_t rays = 0;
            const Times times =
                timesOf([&] { rays = shade::render(*r.traced.intersector, *r.scene, file.render).rays.total(); });
            r.seconds.push_back(times.cpu);
            table.add(joined(
                joined(head, {r.name, std::to_string(frame)}),
                figures({static_cast<double>(r.traced.primitives), static_cast<double>(r.traced.intersector->bytes()),
                         r.build, times.cpu, times.wall, static_cast<double>(rays), r.off})));
        }
    for (const Ready& r : ready) result.all[r.name] = summaryOf(r.seconds);
    return result;
}

// How often one is faster than another, and the geometric mean of how much.
void addContest(std::vector<Row>& rows, const std::vector<SceneResult>& results, const char* own, const char* other) {
    int scenes = 0;
    int won = 0;
    double logs = 0;
    for (const SceneResult& r : results) {
        const Summary* a = r.find(own);
        const Summary* b = r.find(other);
        if (a == nullptr || b == nullptr) continue;
        ++scenes;
        won += a->mean < b->mean ? 1 : 0;
        logs += std::log(b->mean / a->mean);
    }
    if (scenes == 0) return;
    rows.push_back({own, other, fmt::format("{} of {}", won, scenes), fmt::format("{:.2f}", std::exp(logs / scenes))});
}

void addAnswer(Page& page, const std::vector<SceneResult>& results) {
    std::vector<Row> rows;
    for (const char* own : {kExact, kLevelSet})
        for (const char* other : {"low mesh, every triangle", "low mesh, Embree", "fine mesh, Embree"})
            addContest(rows, results, own, other);
    addContest(rows, results, "low mesh, Embree", "low mesh, every triangle");
    page.heading("When is marching better than polygons?");
    page.paragraph(
        "Coarse meshes are also wrong: see the share of pixels that are off. Fine ones look round; of boxes alone the "
        "low mesh is the fine one. A formula takes no memory and is exact at any distance, but its cost grows with the "
        "number of shapes, which a hierarchy's hardly does; a level set's cost does not depend on how its shape is "
        "described, only on the voxels that rays pass.");
    page.table({"this", "beside that", "is faster in scenes", "times as fast, geometric mean"}, rows);
}

}  // namespace

Table studyScenes(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common, Page& page,
                  StudyReport& report) {
    const tbb::global_control one = limitThreads(1);
    const int frames = options.frames > 0 ? options.frames : common.quick ? 2 : 10;
    Table table(kColumns);
    if (!peers.mesh)
        report.findings.emplace_back("meshes with a hierarchy (Embree) are left out: bench_vdbstudy has them");
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
    std::vector<SceneResult> results;
    for (const std::string& scene : options.scenes) {
        results.push_back(measureScene(scene, peers, frames, table, page, common.quick));
        common.tell(results.size(), options.scenes.size());
    }
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
    page.table(table);
    addAnswer(page, results);
    return table;
}

}  // namespace stratum::study
