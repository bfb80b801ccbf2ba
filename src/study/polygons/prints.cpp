#include "base/error.h"
#include "study/cost/own_process.h"
#include "study/polygons/polygons.h"
#include "study/polygons/print_measurement.h"
#include "study/polygons/print_rows.h"
#include "study/print.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <optional>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print",       "sha256",          "integrator",     "light",        "size",
                   "spp",         "threads",         "representation", "extruded_cm3", "enclosed_cm3",
                   "primitives",  "bytes",           "peak_rss_bytes", "read_cpu",     "convert_cpu",
                   "build_cpu",   "render_cpu",      "first_look_cpu", "convert_wall", "build_wall",
                   "render_wall", "first_look_wall", "rays",           "noise",        "bias",
                   "series_cpu"};
constexpr std::size_t kKeys = 8;

constexpr int kFirstLooks = 3;  // processes; their median counts

// Prisms of more sides are the same once more: a quick look leaves them out.
std::vector<Representation> representations(bool quick) {
    std::vector<Representation> all{{kLevelSet, 2},
                                    {"level set, 4 a layer", 4},
                                    {"level set on demand", 2, 0, 0, true},
                                    {"level set on demand, 4 a layer", 4, 0, 0, true},
                                    {"beads, 8:1", 0, 0, 8},
                                    {"4-gons, 8:1", 0, 4, 8}};
    if (!quick) all.insert(all.end(), {{"6-gons, 8:1", 0, 6, 8}, {"10-gons, 8:1", 0, 10, 8}});
    return all;
}

std::vector<Representation> splits(bool quick) {
    std::vector<Representation> all;
    for (const int corners : {0, 4})
        for (const double split : quick ? std::vector{8.0, 0.0} : std::vector{2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 0.0})
            all.push_back({fmt::format("{}, {}", corners == 0 ? "beads" : "4-gons",
                                       split > 0 ? fmt::format("{:g}:1", split) : "whole"),
                           0, corners, split});
    return all;
}

// Pictures of one integrator, for all prints.
struct Task {
    PrintIntegrator integrator;
    Shot shot, small;  // of representations; of segments cut in all ways
    std::vector<PrintResult> results;
    std::map<std::string, std::string> swept;  // class: the print whose segments are cut in all ways
};

Task makeTask(const std::string& name, const PolygonsOptions& options, bool quick) {
    Task task;
    Shot& shot = task.shot;
    shot.integrator = name;
    shot.spp = kComparedSamples;
    if (name == "path") {
        task.integrator = {name, "path tracing with three bounces"};
        shot.light = options.environment.empty() ? "studio" : options.environment;
        if (options.spp > 0) shot.spp = options.spp;
    } else if (name == "ao") {
        task.integrator = {name, "ambient occlusion"};
    } else {
        throw UsageError(fmt::format("{}: no integrator of this study; choose path or ao", name));
    }
    if (quick) {
        shot.width = 64, shot.height = 48;
        if (options.spp == 0 || name == "ao") shot.spp = 4;
    }
    task.small = shot;
    task.small.width /= 4, task.small.height /= 4, task.small.spp = std::max(1, shot.spp / 4);
    shot.noise_spp = kComparedSamples;
    shot.volume = true;
    return task;
}

// Measures what the table does not have yet.
class Measurements {
public:
    Measurements(const PeerTracers& peers, const StudyOptions& common)
        : peers_(peers),
          threads_(common.threads > 0 ? common.threads : tbb::info::default_concurrency()),
          looks_(common.quick ? 1 : kFirstLooks),
          table_(std::make_unique<ResultTable>(common, "polygons_prints.csv", kColumns, kKeys)) {}

    const ResultTable& table() const { return *table_; }
    std::unique_ptr<ResultTable> takeTable() { return std::move(table_); }
    int threads() const { return threads_; }

    /// Nothing where a peer is wanted that is not there. `look_too`: also how long it takes from nothing to a picture.
    std::optional<Row> rowOf(const std::string& path, const std::string& hash, const Representation& r, const Shot& s,
                             bool look_too, const fs::path& picture) {
        const Row key{fs::path(path).filename().string(),
                      hash,
                      s.integrator,
                      s.light.empty() ? "none" : fs::path(s.light).filename().string(),
                      fmt::format("{}x{}", s.width, s.height),
                      std::to_string(s.spp),
                      std::to_string(threads_),
                      r.name};
        if (const Row* known = table_->find(key)) return *known;
        if (r.per_layer == 0 && !peers_.beads) return std::nullopt;
        const auto inChild = [&](const std::function<Row()>& work) {
            const Outcome outcome = inOwnProcess([&] {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(threads_));
                const std::string line = csvLine(work());
                return line.substr(0, line.size() - 1);
            });
            if (!outcome.failure.empty()) throw InputError(fmt::format("{}: {}: {}", path, r.name, outcome.failure));
            return parseCsvLine(outcome.text);
        };
        std::optional<Times> first;
        if (look_too) {
            std::vector<double> wall;
            std::vector<double> cpu;
            for (int n = 0; n < looks_; ++n) {
                const Row look = inChild([&] {
                    const Times times = firstLook(path, r, peers_, s);
                    return Row{fmt::format("{:.17g}", times.wall), fmt::format("{:.17g}", times.cpu)};
                });
                wall.push_back(std::atof(look[0].c_str()));
                cpu.push_back(std::atof(look[1].c_str()));
            }
            std::sort(wall.begin(), wall.end());
            std::sort(cpu.begin(), cpu.end());
            first = Times{wall[wall.size() / 2], cpu[cpu.size() / 2]};
        }
        Row row = key;
        const Row cells = inChild([&] { return measurePrint(path, r, peers_, s, first, picture); });
        row.insert(row.end(), cells.begin(), cells.end());
        table_->add(std::move(row));
        return *table_->find(key);
    }

private:
    const PeerTracers& peers_;
    int threads_;
    int looks_;
    std::unique_ptr<ResultTable> table_;
};

void introduce(Page& page, const Task& task, std::size_t prints, int threads) {
    page.heading(fmt::format("Prints, {}: level sets, beads and prisms (\u0160pilar 2025)", task.integrator.what));
    const std::string light = task.shot.light.empty()
                                  ? std::string("no light, no material")
                                  : fmt::format("a modelled measured material (pla-blue), light: {}",
                                                fs::path(task.shot.light).filename().string());
    const std::string samples =
        task.shot.spp == kComparedSamples
            ? fmt::format("pictures have {} samples a pixel", kComparedSamples)
            : fmt::format("pictures were rendered with {} samples a pixel, and their time is told for {} in proportion",
                          task.shot.spp, kComparedSamples);
    page.paragraph(fmt::format(
        "{} print{}, {}x{} pixels, {} by the same code for all, {}; {}. Times are of {} thread{}, CPU seconds where "
        "wall "
        "is not said. Reading the file is told apart: it is the same for all, and in no total. The level set has 2 "
        "voxels a layer where nothing else is said, and what the outside can't see is culled; on demand, its bricks "
        "are "
        "made when rays come to them, and its primitives are the voxels evaluated. Beads are analytic, cut where they "
        "are longer than eight widths; n-gons are prisms of n sides, cut likewise; both are traced by Embree, in "
        "packets "
        "of 16 where rays run side by side.",
        prints, prints == 1 ? "" : "s", task.shot.width, task.shot.height, task.integrator.what, light, samples,
        threads, threads == 1 ? "" : "s"));
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

std::unique_ptr<ResultTable> studyPrints(const PolygonsOptions& options, const PeerTracers& peers,
                                         const StudyOptions& common, Page& page, StudyReport& report) {
    std::vector<Task> tasks;
    for (const std::string& name :
         options.integrators.empty() ? std::vector<std::string>{"path", "ao"} : options.integrators)
        tasks.push_back(makeTask(name, options, common.quick));
    // Stages of a print take the same time whatever is done with it.
    tasks.front().shot.series = true;
    Measurements measurements(peers, common);
    if (!peers.beads) report.findings.emplace_back("beads and prisms (Embree) are left out: bench_vdbstudy has them");
    const std::vector<Representation> kinds = representations(common.quick);
    const std::vector<Representation> ways = splits(common.quick);
    const fs::path pictures = common.folder / "references";
    fs::create_directories(pictures);
    double done = 0;
    const double steps = static_cast<double>(options.prints.size() * tasks.size());
    for (const std::string& path : options.prints) {
        const std::string hash = shortHash(path);
        for (Task& task : tasks) {
            PrintResult result;
            result.name = fs::path(path).stem().string();
            result.picture = pictures / fmt::format("{}_{}.jpg", result.name, task.integrator.name);
            const auto add = [&](const Representation& r) {
                auto row =
                    measurements.rowOf(path, hash, r, task.shot, true, r.per_layer > 0 ? result.picture : fs::path());
                if (!row) return;
                result.lines.push_back(measurements.table().lineOf(*row));
                result.rows.push_back(std::move(*row));
            };
            for (const Representation& kind : kinds) add(kind);
            result.enclosed = valueOf(result.rows.front(), kEnclosed);
            const std::string size = sizeClassOf(result.enclosed);
            if (task.swept.emplace(size, result.name).first->second == result.name) {
                for (const Representation& way : ways)
                    if (auto row = measurements.rowOf(path, hash, way, task.small, false, {}))
                        result.sweep.push_back(std::move(*row));
            }
            task.results.push_back(std::move(result));
            if (common.progress) common.progress(++done / steps);
        }
    }
    std::vector<std::string> names;
    names.reserve(kinds.size());
    for (const Representation& kind : kinds) names.push_back(kind.name);
    for (Task& task : tasks) {
        std::sort(task.results.begin(), task.results.end(),
                  [](const PrintResult& a, const PrintResult& b) { return a.enclosed < b.enclosed; });
        introduce(page, task, task.results.size(), measurements.threads());
        for (const PrintResult& r : task.results)
            if (fs::exists(r.picture)) page.picture(r.picture, r.name);
        addPrints(page, task.integrator, task.results, names, report);
    }
    report.rows += measurements.table().rows().size();
    report.resumed += measurements.table().resumed();
    return measurements.takeTable();
}

}  // namespace stratum::study
