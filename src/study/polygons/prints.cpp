#include "base/error.h"
#include "base/human_text.h"
#include "study/cost/own_process.h"
#include "study/polygons/polygons.h"
#include "study/polygons/print_measurement.h"
#include "study/polygons/print_page.h"
#include "study/print.h"

#include <fmt/format.h>

#include <filesystem>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstLooks = 3;  // processes; their median counts

// Prisms of more sides are the same once more: a quick look leaves them out.
std::vector<Representation> representations(const PeerTracers& peers, bool quick) {
    std::vector<Representation> all{{"level set", 2},
                                    {"level set, 4 a layer", 4},
                                    {"level set on demand", 2, 0, 0, true},
                                    {"level set on demand, 4 a layer", 4, 0, 0, true}};
    if (peers.beads) all.insert(all.end(), {{"beads, 8:1", 0, 0, 8}, {"4-gons, 8:1", 0, 4, 8}});
    if (peers.beads && !quick) all.insert(all.end(), {{"6-gons, 8:1", 0, 6, 8}, {"10-gons, 8:1", 0, 10, 8}});
    return all;
}

// Pictures of one integrator, for all prints.
struct Task {
    Shot shot;
    std::string what;  // the integrator in words
};

Task makeTask(const std::string& name, const PolygonsOptions& options, bool quick) {
    Task task;
    Shot& shot = task.shot;
    shot.integrator = name;
    if (name == "path") {
        task.what = "path tracing with three bounces";
        shot.light = options.environment.empty() ? "studio" : options.environment;
        if (options.spp > 0) shot.spp = options.spp;
    } else if (name == "ao") {
        task.what = "ambient occlusion";
    } else {
        throw UsageError(fmt::format("{}: no integrator of this study; choose path or ao", name));
    }
    if (quick) {
        shot.width = 64, shot.height = 48;
        if (options.spp == 0 || name == "ao") shot.spp = 4;
    }
    return task;
}

std::string lightOf(const Shot& shot) { return shot.light.empty() ? "none" : fs::path(shot.light).filename().string(); }

// The median of several, each in a process of its own.
Times firstLookOf(const std::string& path, const Representation& r, const PeerTracers& peers, const Shot& shot,
                  const StudyOptions& common) {
    std::vector<double> wall;
    std::vector<double> cpu;
    for (int n = 0; n < (common.quick ? 1 : kFirstLooks); ++n) {
        const Row look = rowInOwnProcess(fmt::format("{}: {}", path, r.name), common.threads, [&] {
            const Times times = firstLook(path, r, peers, shot);
            return figures({times.wall, times.cpu});
        });
        wall.push_back(std::atof(look[0].c_str()));
        cpu.push_back(std::atof(look[1].c_str()));
    }
    return {median(wall), median(cpu)};
}

void introduce(Page& page, const Task& task, std::size_t prints, int threads) {
    page.heading(fmt::format("Prints, {}: level sets, beads and prisms (\u0160pilar 2025)", task.what));
    const std::string light = task.shot.light.empty()
                                  ? std::string("no light, no material")
                                  : "a modelled measured material (pla-blue), light: " + lightOf(task.shot);
    const std::string samples =
        task.shot.spp == kComparedSamples
            ? fmt::format("pictures have {} samples a pixel", kComparedSamples)
            : fmt::format("pictures were rendered with {} samples a pixel, and their time is told for {} in proportion",
                          task.shot.spp, kComparedSamples);
    page.paragraph(fmt::format(
        "{}, {}x{} pixels, {} by the same code for all, {}; {}. Times are of {}, CPU seconds where "
        "wall "
        "is not said. Reading the file is told apart: it is the same for all, and in no total. The level set has 2 "
        "voxels a layer where nothing else is said, and what the outside can't see is culled; on demand, its bricks "
        "are "
        "made when rays come to them, and its primitives are the voxels evaluated. Beads are analytic, cut where they "
        "are longer than eight widths; n-gons are prisms of n sides, cut likewise; both are traced by Embree, in "
        "packets "
        "of 16 where rays run side by side.",
        counted(prints, "print"), task.shot.width, task.shot.height, task.what, light, samples,
        counted(static_cast<std::size_t>(threads), "thread")));
    page.paragraph(fmt::format(
        "\"Convert\" is from beads to level set; \"build\" what rays need besides, the rays that find where the print "
        "stands among it, and on demand the making of bricks: what the picture takes more than the same picture again. "
        "A first look is the whole way in a fresh process, from the beads in memory to a picture of one sample a "
        "pixel: "
        "the median of {}. Noise is the relMSE of a picture of {} samples against its limit, bias that of its limit "
        "against the limit of the uncut analytic beads, from two pictures each of the middle of the frame (see "
        "src/study/picture/image_error.h); a bias around or below zero is less than can be measured.",
        kFirstLooks, kComparedSamples));
}

}  // namespace

Table studyPrints(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common, Page& page,
                  StudyReport& report) {
    std::vector<Task> tasks;
    for (const std::string& name :
         options.integrators.empty() ? std::vector<std::string>{"path", "ao"} : options.integrators)
        tasks.push_back(makeTask(name, options, common.quick));
    if (!peers.beads) report.findings.emplace_back("beads and prisms (Embree) are left out: bench_vdbstudy has them");
    const int threads = common.threads > 0 ? common.threads : tbb::info::default_concurrency();
    Table table(kPrintColumns);
    double done = 0;
    for (const Task& task : tasks) {
        const Shot& shot = task.shot;
        introduce(page, task, options.prints.size(), threads);
        for (const std::string& path : options.prints) {
            const std::string name = fs::path(path).filename().string();
            std::string picture;
            for (const Representation& r : representations(peers, common.quick)) {
                const Times first = firstLookOf(path, r, peers, shot, common);
                Row cells = rowInOwnProcess(fmt::format("{}: {}", path, r.name), threads,
                                            [&] { return measurePrint(path, r, peers, shot, first); });
                if (picture.empty()) picture = cells.back();
                cells.pop_back();
                table.add(joined({name, shortHash(path), shot.integrator, lightOf(shot),
                                  fmt::format("{}x{}", shot.width, shot.height), std::to_string(shot.spp),
                                  std::to_string(threads), r.name},
                                 cells));
            }
            page.picture(picture, name);
            if (common.progress) common.progress(++done / static_cast<double>(options.prints.size() * tasks.size()));
        }
        addPrints(page, table, shot.integrator, task.what, report);
    }
    return table;
}

}  // namespace stratum::study
