// The materials of a picture's objects: from the scene, or else from the files of the prints.
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
#include <utility>
#include <vector>

namespace stratum::assemble {

/// Objects are added one after the other.
class ObjectMaterials {
public:
    /// @param brdf      of objects that have none of their own, see shade::makeBrdf(); empty: not given
    /// @param finishes  materials of stated colors, by "#rrggbb"
    /// @param lines     colors, and the default material, have the gloss of lines: shade::withGlossOfLines()
    explicit ObjectMaterials(const std::string& brdf, std::map<std::string, std::string> finishes = {},
                             bool lines = false);

    /// An object with a given material.
    /// @param attribute  number of `material.by`
    /// @param summary    of that attribute; null without `by`
    void add(const shade::MaterialOptions& material, std::size_t attribute, const trace::AttributeSummary* summary);
    /// An object with the colors that its file states; with the default material where it states none.
    /// @param attribute  number of "color"
    /// @param summary    of it; null unless colors.by_place
    void add(const PrintColors& colors, std::size_t attribute, const trace::AttributeSummary* summary);

    /// By object; empty if all of them are of the scene's material.
    std::vector<shade::ObjectMaterial> materials() const;
    /// The texts of the materials that objects have, each once. One that an attribute colors is there as it was before.
    const std::vector<std::string>& brdfs() const { return used_; }
    /// Text of the scene's material: the one that all objects have, or else the given one or the default.
    std::string brdf() const;
    /// Materials (a list, if there are several), colors, legends, and the number of non-finite values.
    nlohmann::ordered_json report() const;
    /// Of each attribute that colors something, without duplicates.
    const std::vector<shade::Legend>& legends() const { return legends_; }
    /// Why hits need no color lookup; empty if they need one, or if the files' colors are not used.
    std::string noLookup() const { return lookup_ ? std::string() : no_lookup_; }

private:
    std::shared_ptr<const shade::Brdf> brdfOf(const std::string& text);
    /// Lists a text among those in use; nothing stands for the default.
    void use(const std::string& text);
    void explain(const shade::MaterialOptions& material, const trace::AttributeSummary& summary);

    /// The text of the material that an object has for this one.
    std::string materialOf(const std::string& text) const;

    const bool lines_;
    const std::string brdf_;
    const std::map<std::string, std::string> finishes_;
    std::map<std::string, std::shared_ptr<const shade::Brdf>> made_;  // baking a table takes a second
    std::vector<shade::ObjectMaterial> materials_;
    std::vector<shade::Legend> legends_;
    nlohmann::ordered_json colors_ = nlohmann::ordered_json::array();
    nlohmann::ordered_json legend_reports_ = nlohmann::ordered_json::array();
    std::string no_lookup_;
    std::vector<std::string> used_;
    bool own_ = false;  // some object has another material than the scene
    bool lookup_ = false;
};

}  // namespace stratum::assemble
