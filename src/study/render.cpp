#include "study/render.h"

#include "base/error.h"
#include "shade/film/exr_reader.h"
#include "shade/film/picture.h"
#include "shade/post/denoise.h"
#include "study/flip.h"
#include "study/image_error.h"
#include "study/page.h"
#include "study/picture_subject.h"
#include "study/power_law.h"
#include "study/print.h"
#include "study/result_table.h"
#include "study/times.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <set>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

const Row kColumns{"print",        "sha256",      "size", "reference_spp", "variant", "spp",          "seed",
                   "wall_seconds", "cpu_seconds", "rays", "rel_mse",       "flip",    "rel_mse_fine", "flip_fine"};
constexpr std::size_t kKeys = 7;
constexpr std::size_t kVariant = 4, kSpp = 5, kWall = 7, kCpu = 8, kError = 10, kFlip = 11, kFineError = 12;
constexpr int kTimesMore = 64;                      // samples of a reference
constexpr std::uint32_t kReferenceSeed = 0x5eed1e;  // no picture's

// What is compared.
struct Variant {
    std::string name;
    PictureKind kind;
    std::string reference;
    bool apart = false;  // samples that know nothing of each other
    bool denoised = false;
    int least_spp = 1;
    int most_spp = 1 << 30;
};

struct Reference {
    std::string name;
    PictureKind kind;
};

// All that is made, for these voxel sizes (ascending).
struct Plan {
    std::vector<int> per_layer;
    int base = 2;
    std::vector<int> spp;
    std::vector<Reference> references;
    std::vector<Variant> variants;
};

std::string ofSize(int per_layer) { return fmt::format("path, {} a layer", per_layer); }

Plan makePlan(std::vector<int> per_layer, bool quick) {
    Plan plan;
    if (per_layer.empty()) per_layer = quick ? std::vector<int>{1, 2} : std::vector<int>{1, 2, 4, 8};
    std::sort(per_layer.begin(), per_layer.end());
    plan.per_layer = per_layer;
    plan.base = per_layer[(per_layer.size() - 1) / 2];
    for (int n = 1; n <= (quick ? 4 : 32); n *= 2) plan.spp.push_back(n);
    PictureKind path;
    path.per_layer = plan.base;
    path.scene.brdf = "pla-blue";
    PictureKind direct = path;
    direct.integrator.name = "direct";
    PictureKind once = path;
    once.integrator.bounces = 1;
    // What occlusion is: the light of a white sky that comes back from a white and matt surface at once.
    PictureKind white = once;
    white.scene.brdf = "lambert:1,1,1";
    white.scene.env = "constant:1,1,1";
    white.scene.bed = false;
    white.backdrop = shade::Color(1.0f);
    PictureKind ao = white;
    ao.integrator.name = "ao";
    const std::string base = ofSize(plan.base);
    for (const int n : per_layer) {
        PictureKind kind = path;
        kind.per_layer = n;
        plan.references.push_back({ofSize(n), kind});
        if (n != plan.base) plan.variants.push_back({fmt::format("brick, {} a layer", n), kind, ofSize(n)});
    }
    plan.references.push_back({"path, one bounce", once});
    plan.references.push_back({"path, white", white});
    plan.variants.insert(plan.variants.begin(), {"brick", path, base});
    for (const char* march : {"brick floats", "sphere", "vdb"}) {
        PictureKind kind = path;
        kind.march = march;
        plan.variants.push_back({march, kind, base});
    }
    plan.variants.push_back({"samples apart", path, base, true});
    plan.variants.push_back({"denoised", path, base, false, true, 2});
    plan.variants.push_back({"direct", direct, "path, one bounce"});
    plan.variants.push_back({"ao", ao, "path, white"});
    for (const int rows : {8, 16, 32}) {
        PictureKind sum = path;
        sum.integrator.name = "environment-sum";
        sum.integrator.environment_rows = rows;
        plan.variants.push_back(
            {fmt::format("environment sum, {} rows", rows), sum, "path, one bounce", false, false, 1, quick ? 1 : 2});
        if (quick) break;
    }
    return plan;
}

// Pictures with many samples, from files of an earlier run or made now.
class References {
public:
    References(fs::path folder, std::string origin, int spp, PictureSubject& subject)
        : folder_(std::move(folder)), origin_(std::move(origin)), spp_(spp), subject_(subject) {
        std::error_code failed;
        fs::create_directories(folder_, failed);
        if (failed) throw OutputError(fmt::format("{}: can't be made: {}", folder_.string(), failed.message()));
    }

    const shade::Film& of(const Reference& reference) {
        auto& known = films_[reference.name];
        if (!known) known = fromFile(reference.name);
        if (!known) {
            known = subject_.render(reference.kind, spp_, kReferenceSeed).film;
            shade::PictureFile(fileOf(reference.name, "exr")).write(*known, {{"Origin", describe(reference.name)}});
        }
        return *known;
    }
    /// A picture for the page.
    fs::path show(const std::string& name, const shade::Film& film) const {
        fs::path file = fileOf(name, "png");
        shade::PictureFile(file).write(film, {});
        return file;
    }

private:
    std::string describe(const std::string& name) const { return fmt::format("{} {} {}", origin_, spp_, name); }
    fs::path fileOf(std::string name, const char* extension) const {
        std::replace_if(
            name.begin(), name.end(), [](char c) { return c == ' ' || c == ','; }, '_');
        return folder_ / fmt::format("{}.{}", name, extension);
    }
    std::optional<shade::Film> fromFile(const std::string& name) const {
        const fs::path file = fileOf(name, "exr");
        if (!fs::exists(file)) return std::nullopt;
        const auto pixels = static_cast<std::size_t>(subject_.width()) * static_cast<std::size_t>(subject_.height());
        const shade::ExrImage image = shade::readExr(file, pixels);
        const auto origin = image.attributes.find("Origin");
        if (origin == image.attributes.end() || origin->second != describe(name)) return std::nullopt;
        shade::Film film(image.width, image.height, {0, 0, image.width, image.height});
        for (std::size_t n = 0; n < pixels; ++n) film.pixels()[n] = {image.rgb[n], 1.0f};
        return film;
    }

    fs::path folder_;
    std::string origin_;
    int spp_;
    PictureSubject& subject_;
    std::map<std::string, std::optional<shade::Film>> films_;
};

shade::Film pictureOf(const Variant& v, PictureSubject& subject, int spp, std::uint32_t seed, std::uint64_t& rays) {
    shade::RenderOptions options;
    if (v.denoised) shade::addDenoisingGuides(options);
    if (!v.apart) {
        shade::RenderResult result = subject.render(v.kind, spp, seed, options);
        rays = result.rays.total();
        if (v.denoised) shade::denoise(result.film);
        return std::move(result.film);
    }
    // One sample each, of seeds of their own: that is how independent numbers do.
    std::optional<shade::Film> sum;
    for (int n = 0; n < spp; ++n) {
        const shade::RenderResult one =
            subject.render(v.kind, 1, seed * 65536 + static_cast<std::uint32_t>(n) + 1, options);
        rays += one.rays.total();
        if (!sum) sum.emplace(one.film.frameWidth(), one.film.frameHeight(), one.film.region(), one.film.content());
        for (std::size_t p = 0; p < sum->pixels().size(); ++p) {
            sum->pixels()[p].rgb += one.film.pixels()[p].rgb / static_cast<float>(spp);
            sum->pixels()[p].alpha += one.film.pixels()[p].alpha / static_cast<float>(spp);
        }
    }
    return std::move(*sum);
}

// Both shown in the way of the picture: shares are not tone-mapped, and a reference doesn't know that it is one of
// shares.
double flipOf(const shade::Film& reference, const shade::Film& picture) {
    shade::Film same(reference.frameWidth(), reference.frameHeight(), reference.region(), picture.content());
    same.pixels() = reference.pixels();
    return meanFlip(displayed(same), displayed(picture));
}

double value(const Row& row, std::size_t column) { return std::atof(row[column].c_str()); }

// Rows of one variant and number of samples, over its seeds.
struct Point {
    int spp = 0;
    double wall = 0, cpu = 0;                // median
    double error = 0, spread = 0, fine = 0;  // means, and the standard deviation of the error over the seeds
    double flip = 0, flip_spread = 0;
};

class Results {
public:
    explicit Results(const std::vector<Row>& rows) {
        std::map<std::pair<std::string, int>, std::vector<const Row*>> groups;
        for (const Row& row : rows) groups[{row[kVariant], std::atoi(row[kSpp].c_str())}].push_back(&row);
        for (const auto& [key, group] : groups) {
            Point p;
            p.spp = key.second;
            const auto column = [&rows_of = group](std::size_t c) {
                std::vector<double> values;
                values.reserve(rows_of.size());
                for (const Row* row : rows_of) values.push_back(value(*row, c));
                return values;
            };
            const auto median = [](std::vector<double> values) {
                std::sort(values.begin(), values.end());
                return values[values.size() / 2];
            };
            const auto mean = [](const std::vector<double>& values, double& deviation) {
                double sum = 0;
                for (const double v : values) sum += v / static_cast<double>(values.size());
                double squares = 0;
                for (const double v : values) squares += (v - sum) * (v - sum);
                deviation = values.size() > 1 ? std::sqrt(squares / (static_cast<double>(values.size()) - 1)) : 0;
                return sum;
            };
            double unused = 0;
            p.wall = median(column(kWall));
            p.cpu = median(column(kCpu));
            p.error = mean(column(kError), p.spread);
            p.flip = mean(column(kFlip), p.flip_spread);
            p.fine = mean(column(kFineError), unused);
            points_[key.first].push_back(p);  // the keys ascend
        }
    }
    const std::vector<Point>& of(const std::string& variant) const { return points_.at(variant); }

    Series series(const std::string& variant, double Point::*x, double Point::*y, const std::string& name = {},
                  bool dashed = false, int color = -1) const {
        Series s{name.empty() ? variant : name, {}, dashed, true, color};
        for (const Point& p : of(variant)) s.points.emplace_back(p.*x, p.*y);
        return s;
    }

private:
    std::map<std::string, std::vector<Point>> points_;
};

void addComparison(Page& page, const Results& results, const char* title, const std::vector<std::string>& variants) {
    page.heading(title);
    const auto plot = [&](const char* what, const char* x_label, const char* y_label, double Point::*x,
                          double Point::*y) {
        Plot p{fmt::format("{}: {}", title, what), x_label, y_label, true, true, {}};
        for (const std::string& variant : variants) p.series.push_back(results.series(variant, x, y));
        page.plot(p);
    };
    plot("error against CPU time", "CPU seconds", "relMSE", &Point::cpu, &Point::error);
    plot("error against wall time", "wall seconds", "relMSE", &Point::wall, &Point::error);
    plot("what is seen", "CPU seconds", "mean FLIP", &Point::cpu, &Point::flip);
}

void addSlopes(Page& page, const Results& results, const std::vector<Variant>& variants) {
    std::vector<Row> cells;
    const std::vector<Point>& base = results.of(variants.front().name);
    const double aim = base.back().error;  // of the plain one at its best
    for (const Variant& v : variants) {
        const std::vector<Point>& points = results.of(v.name);
        const auto law = [&](double Point::*x, double Point::*y) {
            std::vector<std::pair<double, double>> pairs;
            pairs.reserve(points.size());
            for (const Point& p : points) pairs.emplace_back(p.*x, p.*y);
            return fitPowerLaw(pairs);
        };
        const PowerLaw by_cpu = law(&Point::cpu, &Point::error);
        const double ratio = points.front().cpu / points.front().spp / (base.back().cpu / base.back().spp);
        const Point& last = points.back();
        // Where its line reaches the plain one's best error; nothing where it does not fall.
        const double seconds = std::pow(aim / by_cpu.factor, 1 / by_cpu.exponent);
        const bool reaches = by_cpu.exponent < -0.3 && v.reference == variants.front().reference;
        cells.push_back({v.name, v.reference, std::to_string(last.spp), fmt::format("{:.3f}", last.wall),
                         fmt::format("{:.3f}", last.cpu), fmt::format("{:.2f}", ratio),
                         fmt::format("{:.3e}", last.error),
                         fmt::format("{:.1f}", last.error > 0 ? last.spread / last.error * 100 : 0),
                         fmt::format("{:.4f}", last.flip), fmt::format("{:.2f}", by_cpu.exponent),
                         fmt::format("{:.2f}", law(&Point::cpu, &Point::flip).exponent),
                         reaches ? fmt::format("{:.2f}", seconds) : "-"});
    }
    page.heading("Slopes");
    page.paragraph(
        "At the most samples of each: medians of the times and means of the errors over the seeds, and the standard "
        "deviation of the error from seed to seed. Orders are exponents of the CPU time, least squares of logarithms "
        "over all numbers of samples: -1 is what independent samples give relMSE, -0.5 what they give FLIP where it is "
        "proportional to the error; a number nearer to 0 means that something else than noise is left: bias, or the "
        "reference's own. The last column is the CPU time at which a variant's line meets the best error of the "
        "first, where both have one reference and the line falls.");
    page.table({"variant", "reference", "spp", "wall s", "CPU s", "CPU a sample", "relMSE", "\u00b1 %", "FLIP",
                "order of relMSE", "order of FLIP", "CPU s to the same error"},
               cells);
}

void addEverything(Page& page, const Results& results, const std::vector<Variant>& variants) {
    std::vector<Row> cells;
    for (const Variant& v : variants)
        for (const Point& p : results.of(v.name)) {
            const auto percent = [](double deviation, double mean) {
                return fmt::format("{:.1f}", mean > 0 ? deviation / mean * 100 : 0);
            };
            cells.push_back({v.name, std::to_string(p.spp), fmt::format("{:.4f}", p.wall), fmt::format("{:.4f}", p.cpu),
                             fmt::format("{:.3e}", p.error), percent(p.spread, p.error), fmt::format("{:.4f}", p.flip),
                             percent(p.flip_spread, p.flip)});
        }
    page.heading("Everything measured");
    page.paragraph("Medians of the times; means of the errors, with their standard deviation from seed to seed.");
    page.table({"variant", "spp", "wall s", "CPU s", "relMSE", "\u00b1 %", "FLIP", "\u00b1 %"}, cells);
}

// The error of the voxels alone, as the references show it, beside the noise.
void addVoxels(Page& page, const Results& results, const Plan& plan, References& references) {
    const auto referenceOf = [&](int per_layer) -> const shade::Film& {
        for (const Reference& r : plan.references)
            if (r.name == ofSize(per_layer)) return references.of(r);
        throw UsageError("no reference of that size");
    };
    const auto nameOf = [&](int n) {
        return n == plan.base ? std::string("brick") : fmt::format("brick, {} a layer", n);
    };
    page.heading("Voxel sizes: geometry and noise apart");
    page.paragraph(fmt::format(
        "Against its own reference (same voxels) a picture's error is noise alone. Against the reference of {} voxels "
        "a layer it is noise and geometry. How far the references are from each other is geometry alone: the line on "
        "which the second kind flattens out.",
        plan.per_layer.back()));
    Plot plot{"Noise (full) and all of the error (dashed)", "CPU seconds", "relMSE", true, true, {}};
    std::vector<Row> cells;
    int color = 0;
    for (const int n : plan.per_layer) {
        plot.series.push_back(
            results.series(nameOf(n), &Point::cpu, &Point::error, fmt::format("{} a layer, noise", n), false, color));
        if (n != plan.per_layer.back()) {
            plot.series.push_back(
                results.series(nameOf(n), &Point::cpu, &Point::fine, fmt::format("{} a layer, all", n), true, color));
            const shade::Film& coarse = referenceOf(n);
            const shade::Film& fine = referenceOf(plan.per_layer.back());
            const double bias = relativeSquaredError(coarse, fine);
            const std::vector<Point>& points = results.of(nameOf(n));
            // Noise falls with the order that was measured, from its last point on.
            std::vector<std::pair<double, double>> pairs;
            pairs.reserve(points.size());
            for (const Point& p : points) pairs.emplace_back(p.spp, p.error);
            const PowerLaw noise = fitPowerLaw(pairs);
            cells.push_back({std::to_string(n), fmt::format("{:.3e}", bias),
                             fmt::format("{:.4f}", flipOf(fine, coarse)), fmt::format("{:.3e}", points.back().error),
                             std::to_string(points.back().spp),
                             fmt::format("{:.0f}", std::pow(bias / noise.factor, 1 / noise.exponent))});
        }
        ++color;
    }
    page.plot(plot);
    page.table({"voxels a layer", "relMSE of the geometry", "FLIP of the geometry", "relMSE of the noise", "at spp",
                "spp at which both are equal"},
               cells);
}

}  // namespace

StudyReport studyRender(const RenderStudyOptions& options, const StudyOptions& common) {
    openvdb::initialize();
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(common.threads > 0 ? common.threads : tbb::info::default_concurrency()));
    const Plan plan = makePlan(options.per_layer, common.quick);
    const int seeds = options.seeds > 0 ? options.seeds : common.quick ? 2 : 5;
    const int width = common.quick ? 48 : 200;
    const int height = width / 4 * 3;
    const int reference_spp = kTimesMore * plan.spp.back();
    ResultTable table(common.folder / "render.csv", kColumns, kKeys, common.fresh);
    const std::string name = fs::path(options.print).filename().string();
    const std::string hash = shortHash(options.print);
    const std::string size = fmt::format("{}x{}", width, height);
    PictureSubject subject(options.print, width, height, plan.base);
    References references(common.folder / "references", fmt::format("{} {} {}", name, hash, size), reference_spp,
                          subject);
    const auto referenceNamed = [&](const std::string& wanted) -> const shade::Film& {
        for (const Reference& r : plan.references)
            if (r.name == wanted) return references.of(r);
        throw UsageError(fmt::format("{}: no such reference", wanted));
    };
    const std::string finest = ofSize(plan.per_layer.back());
    std::vector<Row> rows;
    std::set<std::string> warm;
    double done = 0;
    // Seeds outermost: what disturbs the machine for a while disturbs all variants.
    for (int seed = 1; seed <= seeds; ++seed)
        for (const Variant& v : plan.variants)
            for (const int spp : plan.spp) {
                done += 1;
                if (spp < v.least_spp || spp > v.most_spp) continue;
                const Row key{
                    name, hash, size, std::to_string(reference_spp), v.name, std::to_string(spp), std::to_string(seed)};
                if (table.find(key) == nullptr) {
                    const shade::Film& reference = referenceNamed(v.reference);
                    std::uint64_t rays = 0;
                    if (warm.insert(v.name).second) subject.render(v.kind, 1, 0);  // level set, bricks, caches
                    std::optional<shade::Film> film;
                    const Times times =
                        timesOf([&] { film = pictureOf(v, subject, spp, static_cast<std::uint32_t>(seed), rays); });
                    Row row = key;
                    row.push_back(fmt::format("{:.5g}", times.wall));
                    row.push_back(fmt::format("{:.5g}", times.cpu));
                    row.push_back(std::to_string(rays));
                    row.push_back(fmt::format("{:.5g}", relativeSquaredError(*film, reference)));
                    row.push_back(fmt::format("{:.5g}", flipOf(reference, *film)));
                    if (v.kind.integrator.name == "path") {
                        const shade::Film& fine = referenceNamed(finest);
                        row.push_back(fmt::format("{:.5g}", relativeSquaredError(*film, fine)));
                        row.push_back(fmt::format("{:.5g}", flipOf(fine, *film)));
                    } else {
                        row.insert(row.end(), 2, "");
                    }
                    table.add(std::move(row));
                }
                rows.push_back(*table.find(key));
                if (common.progress)
                    common.progress(done / static_cast<double>(plan.variants.size() * plan.spp.size()) / seeds);
            }

    Page page("Pictures: error against run time", common.command);
    page.paragraph(fmt::format(
        "{}, {} pixels, studio light on a modelled measured material (pla-blue), {} seeds of each. References have {} "
        "samples a pixel of a seed that no picture has; that of \"direct\" and of the environment sum is made by the "
        "path integrator with one bounce, that of \"ao\" by the same in a white scene. relMSE is the mean of "
        "(x - r)\u00b2 / (r\u00b2 + 0.01); FLIP is LDR-FLIP (Andersson et al. 2020) at 67 pixels a degree on the "
        "tone-mapped picture. Times are of the render alone, all threads; CPU time is what other work on the machine "
        "disturbs least.",
        name, size, seeds, reference_spp));
    const Results results(rows);
    page.picture(references.show("shown path", referenceNamed(ofSize(plan.base))), "Reference");
    const Variant& plain = plan.variants.front();
    const auto find = [&](const char* wanted) {
        return *std::find_if(plan.variants.begin(), plan.variants.end(),
                             [&](const Variant& v) { return v.name == wanted; });
    };
    std::uint64_t rays = 0;
    page.picture(references.show("shown 4 spp", pictureOf(plain, subject, 4, 1, rays)), "4 samples a pixel");
    page.picture(references.show("shown denoised", pictureOf(find("denoised"), subject, 4, 1, rays)),
                 "4 samples a pixel, denoised");
    addComparison(page, results, "Intersectors", {"brick", "brick floats", "sphere", "vdb"});
    std::vector<std::string> integrators{"brick", "direct", "ao"};
    for (const Variant& v : plan.variants)
        if (v.kind.integrator.name == "environment-sum") integrators.push_back(v.name);
    addComparison(page, results, "Integrators", integrators);
    page.paragraph(
        "\"brick\" is the path integrator with three bounces. The environment sum has no noise but at the edges of "
        "things, so its error stays where it is: the cells of its map.");
    addComparison(page, results, "Samples", {"brick", "samples apart"});
    page.paragraph(
        "There is one sampler. \"Samples apart\" is what it would be without its stratification over the samples of a "
        "pixel: the mean of pictures of one sample and of seeds of their own.");
    addComparison(page, results, "Denoiser", {"brick", "denoised"});
    addVoxels(page, results, plan, references);
    addSlopes(page, results, plan.variants);
    addEverything(page, results, plan.variants);
    StudyReport report;
    report.csv = table.path();
    report.html = common.folder / "render.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    page.write(report.html);
    return report;
}

}  // namespace stratum::study
