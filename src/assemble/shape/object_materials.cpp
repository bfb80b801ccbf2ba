#include "assemble/shape/object_materials.h"

#include "shade/brdf/brdf.h"
#include "shade/finish/line_gloss.h"
#include "shade/finish/named_brdf.h"
#include "shade/palette/filament_color.h"
#include "voxelize/grid/attributes.h"

#include <algorithm>

namespace stratum::assemble {
namespace {

using Json = nlohmann::ordered_json;

Json reportOf(const shade::Legend& legend, const trace::AttributeSummary& summary) {
    Json report{{"attribute", legend.title}};
    if (legend.ramp.empty()) {
        Json names = Json::array();
        for (const auto& entry : legend.entries)
            names.push_back({{"name", entry.name}, {"color", shade::hexOf(entry.color)}});
        report["colors"] = std::move(names);
    } else {
        report["least"] = legend.least;
        report["most"] = legend.most;
        if (!legend.unit.empty()) report["unit"] = legend.unit;
        report["ramp"] = {shade::hexOf(legend.ramp.front()), shade::hexOf(legend.ramp[legend.ramp.size() / 2]),
                          shade::hexOf(legend.ramp.back())};
    }
    if (summary.not_finite > 0) report["not_finite"] = summary.not_finite;
    return report;
}

}  // namespace

ObjectMaterials::ObjectMaterials(const std::string& brdf, std::map<std::string, std::string> finishes, bool lines)
    : lines_(lines), brdf_(materialOf(brdf)), finishes_(std::move(finishes)) {}

std::string ObjectMaterials::materialOf(const std::string& text) const {
    return lines_ ? shade::withGlossOfLines(text) : text;
}

std::shared_ptr<const shade::Brdf> ObjectMaterials::brdfOf(const std::string& text) {
    auto& brdf = made_[text];
    if (!brdf) brdf = shade::makeBrdf(text);
    return brdf;
}

void ObjectMaterials::use(const std::string& text) {
    std::string name = text.empty() ? shade::kDefaultBrdf : text;
    if (std::find(used_.begin(), used_.end(), name) == used_.end()) used_.push_back(std::move(name));
}

void ObjectMaterials::explain(const shade::MaterialOptions& material, const trace::AttributeSummary& summary) {
    lookup_ = true;
    shade::Legend legend = shade::makeLegend(material, summary, materials_.back());
    if (!legend.ramp.empty()) legend.unit = voxelize::attributeUnit(material.by);
    Json report = reportOf(legend, summary);
    if (std::find(legend_reports_.begin(), legend_reports_.end(), report) != legend_reports_.end()) return;
    legend_reports_.push_back(std::move(report));
    legends_.push_back(std::move(legend));
}

void ObjectMaterials::add(const shade::MaterialOptions& material, std::size_t attribute,
                          const trace::AttributeSummary* summary) {
    own_ = own_ || !material.by.empty() || !material.brdf.empty();
    const std::string text = material.brdf.empty() ? brdf_ : materialOf(material.brdf);
    use(text);
    if (summary == nullptr) {
        materials_.emplace_back(brdfOf(text));
        return;
    }
    for (const auto& each : material.each) use(each.second);
    materials_.push_back(shade::makeObjectMaterial(material, brdf_, attribute, *summary));
    explain(material, *summary);
}

void ObjectMaterials::add(const PrintColors& colors, std::size_t attribute, const trace::AttributeSummary* summary) {
    for (const Json& color : colors.report)
        if (std::find(colors_.begin(), colors_.end(), color) == colors_.end()) colors_.push_back(color);
    std::map<std::string, std::string> finishes = finishes_;
    finishes.insert(colors.finishes.begin(), colors.finishes.end());
    if (summary != nullptr) {
        shade::MaterialOptions material;
        material.by = "color";
        material.each = std::move(finishes);
        add(material, attribute, summary);
        return;
    }
    no_lookup_ = colors.stated.empty() ? "the file states no colour" : "the print has one colour";
    std::string text = colors.stated.empty() ? std::string() : colors.stated.front();
    if (const auto finish = finishes.find(text); finish != finishes.end()) text = finish->second;
    own_ = own_ || !colors.stated.empty();
    text = materialOf(text);
    use(text);
    materials_.emplace_back(brdfOf(text));
}

std::vector<shade::ObjectMaterial> ObjectMaterials::materials() const {
    return own_ ? materials_ : std::vector<shade::ObjectMaterial>();
}

std::string ObjectMaterials::brdf() const {
    if (used_.size() == 1) return used_.front();
    return brdf_.empty() ? shade::kDefaultBrdf : brdf_;
}

Json ObjectMaterials::report() const {
    Json report{{"brdf", used_.size() > 1 ? Json(used_) : Json(brdf())}};
    if (!colors_.empty()) report["colors"] = colors_;
    if (!legend_reports_.empty()) report["legend"] = legend_reports_;
    return report;
}

}  // namespace stratum::assemble
