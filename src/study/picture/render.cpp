#include "study/study.h"

#include "assemble/finished_picture.h"
#include "march/brick/brick_intersector.h"
#include "march/reference/reference_intersectors.h"
#include "shade/integrator/render.h"
#include "shade/post/denoise.h"
#include "shade/scene/scene.h"
#include "study/cost/times.h"
#include "study/picture/flip.h"
#include "study/picture/image_error.h"
#include "study/picture/render_page.h"
#include "study/picture/thumbnail.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColumns =
    "print,sha256,size,reference_spp,variant,spp,seed,wall_seconds,cpu_seconds,rays,rel_mse,flip,rel_mse_fine,"
    "flip_fine";
constexpr int kTimesMore = 64;                       // samples of a reference
constexpr std::uint32_t kReferenceSeed = 0x5eed1e;   // no picture's
constexpr const char* kDefault = "default picture";  // vdbtrace's, when nobody asks for samples or denoising

// A way to make the picture, but for its samples.
struct Kind {
    int per_layer = 2;
    std::string march = "brick";  // brick, brick floats, sphere, vdb
    shade::SceneOptions scene;
    std::optional<shade::Color> backdrop;  // instead of what makeScene() puts there
    shade::IntegratorOptions integrator;
};

struct Variant {
    std::string name;
    Kind kind;
    std::string reference;  // the name of one
    bool apart = false;     // samples that know nothing of each other
    bool denoised = false;
    int least_spp = 1;
    int only_spp = 0;  // above 0: this number alone, whatever the others have
};

struct Plan {
    int width = 200, height = 150;
    std::vector<int> per_layer;  // voxel sizes, ascending
    int base = 2;                // the middle one: of all comparisons but that of the sizes
    std::vector<int> spp;
    std::map<std::string, Kind> references;
    std::vector<Variant> variants;

    std::string brickOf(int n) const { return n == base ? "brick" : fmt::format("brick, {} a layer", n); }
};

std::string ofSize(int per_layer) { return fmt::format("path, {} a layer", per_layer); }

Plan makePlan(std::vector<int> per_layer, bool quick) {
    Plan plan;
    if (quick) plan.width = 48, plan.height = 36;
    if (per_layer.empty()) per_layer = quick ? std::vector<int>{1, 2} : std::vector<int>{1, 2, 4, 8};
    std::sort(per_layer.begin(), per_layer.end());
    plan.per_layer = per_layer;
    plan.base = per_layer[(per_layer.size() - 1) / 2];
    for (int n = 1; n <= (quick ? 4 : 32); n *= 2) plan.spp.push_back(n);
    Kind path;
    path.per_layer = plan.base;
    path.scene.brdf = "pla-blue";
    Kind direct = path;
    direct.integrator.name = "direct";
    Kind once = path;
    once.integrator.bounces = 1;
    // What occlusion is: the light of a white sky that comes back from a white and matt surface at once.
    Kind white = once;
    white.scene.brdf = "lambert:1,1,1";
    white.scene.env = "constant:1,1,1";
    white.scene.bed = false;
    white.backdrop = shade::Color(1.0f);
    Kind ao = white;
    ao.integrator.name = "ao";
    const std::string base = ofSize(plan.base);
    plan.variants.push_back({"brick", path, base});
    for (const int n : per_layer) {
        Kind kind = path;
        kind.per_layer = n;
        plan.references[ofSize(n)] = kind;
        if (n != plan.base) plan.variants.push_back({plan.brickOf(n), kind, ofSize(n)});
    }
    plan.references["path, one bounce"] = once;
    plan.references["path, white"] = white;
    for (const char* march : {"brick floats", "sphere", "vdb"}) {
        Kind kind = path;
        kind.march = march;
        plan.variants.push_back({march, kind, base});
    }
    plan.variants.push_back({"samples apart", path, base, true});
    plan.variants.push_back({"denoised", path, base, false, true, 2});
    shade::RenderOptions chosen;
    chosen.width = plan.width;
    chosen.height = plan.height;
    const bool denoised = assemble::chooseDenoising({}, chosen);
    plan.variants.push_back({kDefault, path, base, false, denoised, 1, chosen.spp});
    plan.variants.push_back({"direct", direct, "path, one bounce"});
    plan.variants.push_back({"ao", ao, "path, white"});
    return plan;
}

// FLIP of both, displayed as `picture` is: shares are not tone-mapped, and a reference doesn't know that it is one of
// shares.
double flipOf(const shade::Film& reference, const shade::Film& picture) {
    shade::Film same(reference.frameWidth(), reference.frameHeight(), reference.region(), picture.content());
    same.pixels() = reference.pixels();
    return meanFlip(displayed(same), displayed(picture));
}

// One print as many level sets under one camera. What is made is kept.
class Pictures {
public:
    Pictures(const std::string& print, const Plan& plan) : plan_(plan), toolpath_(readPrint(print)) {
        beads_ = voxelize::selectBeads(toolpath_, {});
    }

    int referenceSpp() const { return kTimesMore * plan_.spp.back(); }
    const shade::Film& reference(const std::string& name) {
        auto& known = references_[name];
        if (!known) known = render(plan_.references.at(name), referenceSpp(), kReferenceSeed).film;
        return *known;
    }
    shade::Film picture(const Variant& v, int spp, std::uint32_t seed, std::uint64_t& rays);
    shade::RenderResult render(const Kind& kind, int spp, std::uint32_t seed, shade::RenderOptions options = {}) {
        options.width = plan_.width;
        options.height = plan_.height;
        options.spp = spp;
        options.seed = seed;
        options.integrator = kind.integrator;
        return shade::render(intersector(kind.per_layer, kind.march), scene(kind), options);
    }

private:
    const trace::Intersector& intersector(int per_layer, const std::string& march) {
        auto& known = intersectors_[{per_layer, march}];
        if (known) return *known;
        openvdb::FloatGrid::Ptr& grid = grids_[per_layer];
        if (!grid) grid = voxelize::voxelize(toolpath_, beads_, latticeOf(toolpath_, beads_, per_layer));
        known = march == "brick"          ? march::makeBrickIntersector(*grid)
                : march == "brick floats" ? march::makeBrickIntersector(*grid, march::BrickValues::Float32)
                : march == "sphere"       ? march::makeSphereIntersector(grid)
                                          : march::makeVdbIntersector(grid);
        return *known;
    }
    // One for all level sets: of theirs it would differ by the boxes of their narrow bands, and a hair in the bed's
    // height.
    const shade::SceneDescription& scene(const Kind& kind) {
        auto& known = scenes_[kind.scene.brdf];
        if (known) return *known;
        known = shade::makeScene(kind.scene, intersector(plan_.base, "brick"), plan_.width, plan_.height);
        if (kind.backdrop) known->backdrop = shade::Backdrop{*kind.backdrop, *kind.backdrop};
        return *known;
    }

    const Plan& plan_;
    gcode::Toolpath toolpath_;
    std::vector<std::uint32_t> beads_;
    std::map<int, openvdb::FloatGrid::Ptr> grids_;
    std::map<std::pair<int, std::string>, std::unique_ptr<trace::Intersector>> intersectors_;
    std::map<std::string, std::optional<shade::SceneDescription>> scenes_;  // by material
    std::map<std::string, std::optional<shade::Film>> references_;
};

shade::Film Pictures::picture(const Variant& v, int spp, std::uint32_t seed, std::uint64_t& rays) {
    shade::RenderOptions options;
    if (v.denoised) shade::addDenoisingGuides(options);
    if (!v.apart) {
        shade::RenderResult result = render(v.kind, spp, seed, options);
        rays = result.rays.total();
        if (v.denoised) shade::denoise(result.film);
        return std::move(result.film);
    }
    // One sample each, of seeds of their own: that is how independent numbers do.
    std::optional<shade::Film> sum;
    for (int n = 0; n < spp; ++n) {
        const shade::RenderResult one = render(v.kind, 1, seed * 65536 + static_cast<std::uint32_t>(n) + 1, options);
        rays += one.rays.total();
        if (!sum) sum.emplace(one.film.frameWidth(), one.film.frameHeight(), one.film.region(), one.film.content());
        for (std::size_t p = 0; p < sum->pixels().size(); ++p) {
            sum->pixels()[p].rgb += one.film.pixels()[p].rgb / static_cast<float>(spp);
            sum->pixels()[p].alpha += one.film.pixels()[p].alpha / static_cast<float>(spp);
        }
    }
    return std::move(*sum);
}

// The cells from "wall_seconds" on.
Row measure(Pictures& pictures, const Plan& plan, const Variant& v, int spp, int seed) {
    const shade::Film& reference = pictures.reference(v.reference);
    std::uint64_t rays = 0;
    std::optional<shade::Film> film;
    const Times times = timesOf([&] { film = pictures.picture(v, spp, static_cast<std::uint32_t>(seed), rays); });
    const Row row = figures({times.wall, times.cpu, static_cast<double>(rays), relativeSquaredError(*film, reference),
                             flipOf(reference, *film)});
    if (v.kind.integrator.name != "path") return joined(row, {"", ""});
    const shade::Film& fine = pictures.reference(ofSize(plan.per_layer.back()));
    return joined(row, figures({relativeSquaredError(*film, fine), flipOf(fine, *film)}));
}

void fillPage(Page& page, Pictures& pictures, const Plan& plan, const Table& table) {
    const RenderResults results = renderResults(table);
    std::uint64_t rays = 0;
    page.picture(jpegOf(pictures.reference(ofSize(plan.base))), "Reference");
    Variant plain = plan.variants.front();
    page.picture(jpegOf(pictures.picture(plain, 4, 1, rays)), "4 samples a pixel");
    plain.denoised = true;
    page.picture(jpegOf(pictures.picture(plain, 4, 1, rays)), "4 samples a pixel, denoised");
    addComparison(page, results, "Intersectors", {"brick", "brick floats", "sphere", "vdb"});
    addComparison(page, results, "Integrators", {"brick", "direct", "ao"});
    page.paragraph("\"brick\" is the path integrator with three bounces.");
    addComparison(page, results, "Samples", {"brick", "samples apart"});
    page.paragraph(
        "There is one sampler. \"Samples apart\" is what it would be without its stratification over the samples of a "
        "pixel: the mean of pictures of one sample and of seeds of their own.");
    addComparison(page, results, "Denoiser", {"brick", "denoised", kDefault});
    page.paragraph(fmt::format(
        "The {} is what vdbtrace makes when nobody asks for samples or denoising: at this size {} samples a pixel, "
        "denoised. \"brick\" is unbiased; the denoiser is a filter after it, whose bias is what is left when its line "
        "gets flat.",
        kDefault, results.at(kDefault).front().spp));
    std::vector<VoxelBias> sizes;
    const shade::Film& fine = pictures.reference(ofSize(plan.per_layer.back()));
    for (const int n : plan.per_layer) {
        const shade::Film& own = pictures.reference(ofSize(n));
        sizes.push_back({n, plan.brickOf(n), relativeSquaredError(own, fine), flipOf(fine, own)});
    }
    addVoxels(page, results, sizes);
    std::vector<std::pair<std::string, std::string>> names;
    for (const Variant& v : plan.variants) names.emplace_back(v.name, v.reference);
    addSlopes(page, results, names);
    page.heading("Everything measured");
    page.table(table);
}

}  // namespace

StudyReport studyRender(const RenderStudyOptions& options, const StudyOptions& common) {
    openvdb::initialize();
    const tbb::global_control limit = limitThreads(common.threads);
    const Plan plan = makePlan(options.per_layer, common.quick);
    const int seeds = options.seeds > 0 ? options.seeds : common.quick ? 2 : 5;
    Pictures pictures(options.print, plan);
    const std::string name = fs::path(options.print).filename().string();
    const std::string size = fmt::format("{}x{}", plan.width, plan.height);
    const Row head{name, shortHash(options.print), size, std::to_string(pictures.referenceSpp())};
    Table table(kColumns);
    std::set<std::string> warm;  // variants of which a picture has been made
    double done = 0;
    // Seeds outermost: what disturbs the machine for a while disturbs all variants.
    for (int seed = 1; seed <= seeds; ++seed)
        for (const Variant& v : plan.variants) {
            if (warm.insert(v.name).second) pictures.render(v.kind, 1, 0);  // level set, bricks, caches
            for (const int spp : v.only_spp > 0 ? std::vector<int>{v.only_spp} : plan.spp)
                if (spp >= v.least_spp)
                    table.add(joined(joined(head, {v.name, std::to_string(spp), std::to_string(seed)}),
                                     measure(pictures, plan, v, spp, seed)));
            if (common.progress) common.progress(++done / static_cast<double>(plan.variants.size()) / seeds);
        }
    Page page("Pictures: error against run time", common.command);
    page.paragraph(fmt::format(
        "{}, {} pixels, studio light on a modelled measured material (pla-blue), {} seeds of each. References have {} "
        "samples a pixel of a seed that no picture has; that of \"direct\" is made by the path integrator with one "
        "bounce, that of \"ao\" by the same in a white scene. relMSE is the mean of "
        "(x - r)\u00b2 / (r\u00b2 + 0.01); FLIP is LDR-FLIP (Andersson et al. 2020) at 67 pixels a degree on the "
        "tone-mapped picture. Times are of the render alone, all threads; CPU time is what other work on the machine "
        "disturbs least.",
        name, size, seeds, pictures.referenceSpp()));
    fillPage(page, pictures, plan, table);
    StudyReport report;
    writeTable(common, "render", table, report);
    writePage(common, "render", page, report);
    return report;
}

}  // namespace stratum::study
