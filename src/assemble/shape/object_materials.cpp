#include "assemble/shape/object_materials.h"

#include "shade/brdf/brdf.h"
#include "shade/palette/filament_color.h"

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

std::shared_ptr<const shade::Brdf> ObjectMaterials::brdfOf(const std::string& text) {
    auto& brdf = made_[text];
    if (!brdf) brdf = shade::makeBrdf(text);
    return brdf;
}

void ObjectMaterials::explain(const shade::MaterialOptions& material, const trace::AttributeSummary& summary) {
    lookup_ = true;
    shade::Legend legend = shade::makeLegend(material, summary, materials_.back());
    Json report = reportOf(legend, summary);
    if (std::find(legend_reports_.begin(), legend_reports_.end(), report) != legend_reports_.end()) return;
    legend_reports_.push_back(std::move(report));
    legends_.push_back(std::move(legend));
}

void ObjectMaterials::add(const shade::MaterialOptions& material, std::size_t attribute,
                          const trace::AttributeSummary* summary) {
    own_ = own_ || !material.by.empty() || !material.brdf.empty();
    if (summary == nullptr) {
        materials_.emplace_back(brdfOf(material.brdf.empty() ? brdf_ : material.brdf));
        return;
    }
    materials_.push_back(shade::makeObjectMaterial(material, brdf_, attribute, *summary));
    explain(material, *summary);
}

void ObjectMaterials::add(const PrintColors& colors, std::size_t attribute, const trace::AttributeSummary* summary) {
    for (const Json& color : colors.report)
        if (std::find(colors_.begin(), colors_.end(), color) == colors_.end()) colors_.push_back(color);
    if (summary != nullptr) {
        shade::MaterialOptions material;
        material.by = "color";
        material.each = finishes_;
        add(material, attribute, summary);
        return;
    }
    no_lookup_ = colors.stated.empty() ? "the file states no colour" : "the print has one colour";
    only_color_ = colors.stated.empty() ? std::string() : colors.stated.front();
    if (const auto finish = finishes_.find(only_color_); finish != finishes_.end()) only_color_ = finish->second;
    own_ = own_ || !colors.stated.empty();
    materials_.emplace_back(brdfOf(only_color_));
}

std::vector<shade::ObjectMaterial> ObjectMaterials::materials() const {
    return own_ ? materials_ : std::vector<shade::ObjectMaterial>();
}

std::string ObjectMaterials::brdf() const {
    if (!brdf_.empty()) return brdf_;
    return materials_.size() == 1 && !only_color_.empty() ? only_color_ : shade::kDefaultBrdf;
}

Json ObjectMaterials::report() const {
    Json report{{"brdf", brdf()}};
    if (!colors_.empty()) report["colors"] = colors_;
    if (!legend_reports_.empty()) report["legend"] = legend_reports_;
    return report;
}

}  // namespace stratum::assemble
