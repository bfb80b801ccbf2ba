#include "study/picture/render_plan.h"

#include "assemble/finished_picture.h"
#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::study {
namespace {

template <typename Named>
const Named& find(const std::vector<Named>& all, const std::string& name) {
    for (const Named& one : all)
        if (one.name == name) return one;
    throw UsageError(fmt::format("{}: no part of this study", name));
}

}  // namespace

const Reference& RenderPlan::referenceNamed(const std::string& name) const { return find(references, name); }

const Variant& RenderPlan::variantNamed(const std::string& name) const { return find(variants, name); }

std::string ofSize(int per_layer) { return fmt::format("path, {} a layer", per_layer); }

RenderPlan makePlan(std::vector<int> per_layer, bool quick) {
    RenderPlan plan;
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
    shade::RenderOptions chosen;
    chosen.width = pictureWidth(quick);
    chosen.height = chosen.width / 4 * 3;
    const bool denoised = assemble::chooseDenoising({}, chosen);
    plan.variants.push_back({kDefaultPicture, path, base, false, denoised, 1, 1 << 30, chosen.spp});
    plan.variants.push_back({"direct", direct, "path, one bounce"});
    plan.variants.push_back({"ao", ao, "path, white"});
    return plan;
}

}  // namespace stratum::study
