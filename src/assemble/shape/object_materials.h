// What the objects of a picture are made of: as a scene says, or else as the files of the prints do.
#pragma once

#include "assemble/print/print_colors.h"
#include "shade/film/legend.h"
#include "shade/scene/material.h"
#include "trace/attribute.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace stratum::assemble {

/// Takes one object after the other.
class ObjectMaterials {
public:
    /// @param brdf  of objects that have none of their own, see shade::makeBrdf(); empty: nobody said
    explicit ObjectMaterials(const std::string& brdf) : brdf_(brdf) {}

    /// One of a material that somebody asked for.
    /// @param attribute  number of `material.by`
    /// @param summary    of that attribute; null without `by`
    void add(const shade::MaterialOptions& material, std::size_t attribute, const trace::AttributeSummary* summary);
    /// One of the colours that its file states; of the default material where it states none.
    /// @param attribute  number of "color"
    /// @param summary    of it; null unless colors.by_place
    void add(const PrintColors& colors, std::size_t attribute, const trace::AttributeSummary* summary);

    /// By object; empty if all of them are of the scene's material.
    std::vector<shade::ObjectMaterial> materials() const;
    /// Text of the scene's material: the one given, or the one colour that the only object's file states, or the
    /// default.
    std::string brdf() const;
    /// Material, colours, legends, and how many values were no numbers.
    nlohmann::ordered_json report() const;
    /// Of each attribute that colours something, as often as they differ.
    const std::vector<shade::Legend>& legends() const { return legends_; }
    /// Why no hit has to look for its colour; empty if one has to, or if the files were not asked for colours.
    std::string noLookup() const { return lookup_ ? std::string() : no_lookup_; }

private:
    std::shared_ptr<const shade::Brdf> brdfOf(const std::string& text);
    void explain(const shade::MaterialOptions& material, const trace::AttributeSummary& summary);

    const std::string brdf_;
    std::map<std::string, std::shared_ptr<const shade::Brdf>> made_;  // baking a table takes a second
    std::vector<shade::ObjectMaterial> materials_;
    std::vector<shade::Legend> legends_;
    nlohmann::ordered_json colors_ = nlohmann::ordered_json::array();
    nlohmann::ordered_json legend_reports_ = nlohmann::ordered_json::array();
    std::string only_color_, no_lookup_;
    bool own_ = false;  // some object has another material than the scene
    bool lookup_ = false;
};

}  // namespace stratum::assemble
