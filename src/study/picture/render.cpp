#include "study/picture/render.h"

#include "shade/post/denoise.h"
#include "study/cost/times.h"
#include "study/picture/image_error.h"
#include "study/picture/render_results.h"
#include "study/print.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <optional>
#include <set>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr int kTimesMore = 64;  // samples of a reference

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

// The study of one print: its pictures, and what they are compared with.
class RenderStudy {
public:
    RenderStudy(const RenderStudyOptions& options, const StudyOptions& common)
        : common_(common),
          plan_(makePlan(options.per_layer, common.quick)),
          seeds_(options.seeds > 0 ? options.seeds
                 : common.quick    ? 2
                                   : 5),
          reference_spp_(kTimesMore * plan_.spp.back()),
          table_(common, "render.csv", kRenderColumns, kRenderKeys),
          name_(fs::path(options.print).filename().string()),
          hash_(shortHash(options.print)),
          size_(fmt::format("{}x{}", width(), height())),
          subject_(options.print, width(), height(), plan_.base),
          references_(common.folder / "references", fmt::format("{} {} {}", name_, hash_, size_), reference_spp_,
                      subject_) {}

    const ResultTable& table() const { return table_; }

    /// Makes all pictures that the table does not have yet.
    void measure() {
        double done = 0;
        // Seeds outermost: what disturbs the machine for a while disturbs all variants.
        for (int seed = 1; seed <= seeds_; ++seed)
            for (const Variant& v : plan_.variants)
                for (const int spp : v.only_spp > 0 ? std::vector<int>{v.only_spp} : plan_.spp) {
                    done += v.only_spp > 0 ? static_cast<double>(plan_.spp.size()) : 1;
                    if (v.only_spp == 0 && (spp < v.least_spp || spp > v.most_spp)) continue;
                    const Row key{name_,
                                  hash_,
                                  size_,
                                  std::to_string(reference_spp_),
                                  v.name,
                                  std::to_string(spp),
                                  std::to_string(seed)};
                    if (table_.find(key) == nullptr) table_.add(measured(key, v, spp, seed));
                    rows_.push_back(*table_.find(key));
                    if (common_.progress)
                        common_.progress(done / static_cast<double>(plan_.variants.size() * plan_.spp.size()) / seeds_);
                }
    }

    void write(const fs::path& html);

private:
    int width() const { return pictureWidth(common_.quick); }
    int height() const { return width() / 4 * 3; }
    const shade::Film& referenceNamed(const std::string& name) { return references_.of(plan_.referenceNamed(name)); }
    Row measured(Row row, const Variant& v, int spp, int seed);

    const StudyOptions& common_;
    RenderPlan plan_;
    int seeds_;
    int reference_spp_;
    ResultTable table_;
    std::string name_, hash_, size_;
    PictureSubject subject_;
    References references_;
    std::vector<Row> rows_;
    std::set<std::string> warm_;  // variants of which a picture has been made
};

// `row`: its key.
Row RenderStudy::measured(Row row, const Variant& v, int spp, int seed) {
    const shade::Film& reference = referenceNamed(v.reference);
    std::uint64_t rays = 0;
    if (warm_.insert(v.name).second) subject_.render(v.kind, 1, 0);  // level set, bricks, caches
    std::optional<shade::Film> film;
    const Times times = timesOf([&] { film = pictureOf(v, subject_, spp, static_cast<std::uint32_t>(seed), rays); });
    row.push_back(fmt::format("{:.5g}", times.wall));
    row.push_back(fmt::format("{:.5g}", times.cpu));
    row.push_back(std::to_string(rays));
    row.push_back(fmt::format("{:.5g}", relativeSquaredError(*film, reference)));
    row.push_back(fmt::format("{:.5g}", flipOf(reference, *film)));
    if (v.kind.integrator.name == "path") {
        const shade::Film& fine = referenceNamed(ofSize(plan_.per_layer.back()));
        row.push_back(fmt::format("{:.5g}", relativeSquaredError(*film, fine)));
        row.push_back(fmt::format("{:.5g}", flipOf(fine, *film)));
    } else {
        row.insert(row.end(), 2, "");
    }
    return row;
}

void RenderStudy::write(const fs::path& html) {
    Page page("Pictures: error against run time", common_.command);
    page.paragraph(fmt::format(
        "{}, {} pixels, studio light on a modelled measured material (pla-blue), {} seeds of each. References have {} "
        "samples a pixel of a seed that no picture has; that of \"direct\" is made by the path integrator with one "
        "bounce, that of \"ao\" by the same in a white scene. relMSE is the mean of "
        "(x - r)\u00b2 / (r\u00b2 + 0.01); FLIP is LDR-FLIP (Andersson et al. 2020) at 67 pixels a degree on the "
        "tone-mapped picture. Times are of the render alone, all threads; CPU time is what other work on the machine "
        "disturbs least.",
        name_, size_, seeds_, reference_spp_));
    const RenderResults results(rows_, table_);
    page.picture(references_.show("shown path", referenceNamed(ofSize(plan_.base))), "Reference");
    std::uint64_t rays = 0;
    const auto fewSamples = [&](const Variant& v) { return pictureOf(v, subject_, 4, 1, rays); };
    page.picture(references_.show("shown 4 spp", fewSamples(plan_.variants.front())), "4 samples a pixel");
    page.picture(references_.show("shown denoised", fewSamples(plan_.variantNamed("denoised"))),
                 "4 samples a pixel, denoised");
    addComparison(page, results, "Intersectors", {"brick", "brick floats", "sphere", "vdb"});
    addComparison(page, results, "Integrators", {"brick", "direct", "ao"});
    page.paragraph("\"brick\" is the path integrator with three bounces.");
    addComparison(page, results, "Samples", {"brick", "samples apart"});
    page.paragraph(
        "There is one sampler. \"Samples apart\" is what it would be without its stratification over the samples of a "
        "pixel: the mean of pictures of one sample and of seeds of their own.");
    addComparison(page, results, "Denoiser", {"brick", "denoised", kDefaultPicture});
    page.paragraph(fmt::format(
        "The {} is what vdbtrace makes when nobody asks for samples or denoising: at this size {} samples a pixel, "
        "denoised. \"brick\" is unbiased; the denoiser is a filter after it, whose bias is what is left when its "
        "line gets flat.",
        kDefaultPicture, plan_.variantNamed(kDefaultPicture).only_spp));
    addVoxels(page, results, plan_, references_);
    addSlopes(page, results, plan_.variants);
    addEverything(page, results, plan_.variants);
    page.runs(table_);
    page.write(html);
}

}  // namespace

StudyReport studyRender(const RenderStudyOptions& options, const StudyOptions& common) {
    openvdb::initialize();
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(common.threads > 0 ? common.threads : tbb::info::default_concurrency()));
    RenderStudy study(options, common);
    study.measure();
    StudyReport report;
    report.csv = study.table().path();
    report.html = common.folder / "render.html";
    report.rows = study.table().rows().size();
    report.resumed = study.table().resumed();
    study.write(report.html);
    return report;
}

}  // namespace stratum::study
