#include "assemble/traced_objects.h"

#include "assemble/file/file_facts.h"
#include "assemble/shape/object_materials.h"
#include "assemble/shape/shape.h"
#include "base/error.h"
#include "shade/finish/line_gloss.h"
#include "trace/box_corners.h"
#include "trace/clip_intersector.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

namespace stratum::assemble {
namespace {

using Json = nlohmann::ordered_json;

// Space of the file -> that space with z up -> world.
trace::Placement upright(const trace::Placement& placement) {
    trace::Placement result = placement;
    result.linear *= trace::Placement::of(glm::dvec3(1.0), {90.0, 0.0, 0.0}, glm::dvec3(0.0)).linear;
    return result;
}

// Adds a placed shape to the box and the outline of all parts: all of it, if its file doesn't state the part's box.
void include(std::optional<trace::Box>& parts, std::vector<glm::dvec3>& outline, const Shape& shape,
             const trace::Placement& placement) {
    const trace::Box own = shape.part.value_or(shape.intersector->bounds());
    if (!std::isfinite(glm::dot(own.max - own.min, glm::dvec3(1.0)))) return;  // a shape by formula may have no end
    const auto placed = [&placement](const glm::dvec3& place) { return placement.linear * place + placement.offset; };
    const auto corners = trace::cornersOf(own);
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 world = placed(corner);
        if (!parts) parts = trace::Box{world, world};
        parts->min = glm::min(parts->min, world);
        parts->max = glm::max(parts->max, world);
    }
    const std::span<const glm::dvec3> points =
        shape.outline.empty() ? std::span<const glm::dvec3>(corners) : shape.outline;
    for (const glm::dvec3& point : points) outline.push_back(placed(point));
}

/// What one object is made of.
struct MaterialPlan {
    shade::MaterialOptions material;
    bool stated_colors = false;  // those of its file, because no material is given
    std::string by;              // the attribute that colours it; empty: none
};

// Numbers the labels, which every file must have.
void planLabels(const std::vector<ObjectOptions>& objects, const TracingOptions& options, AttributeNeeds& needs,
                TracedObjects& result) {
    for (const shade::Label label : options.labels) {
        const std::string name(shade::labelName(label));
        result.labels[static_cast<std::size_t>(label)] = needs.number(name);
        for (const ObjectOptions& object : objects)
            if (!object.sdf) needs.add(object, name);
    }
}

// Whether lines on tops are modelled: then plain plastic has their gloss, too.
bool showsLines(const PrintRequest& prints) {
    return (prints.toolpath ? prints.toolpath->deposit : prints.print.read.deposit).crown > 0;
}

// Whether a material of the object has the gloss of lines.
bool needsGrain(const ObjectOptions& object, const TracingOptions& options) {
    if (object.sdf) return false;
    const auto any = [](const auto& texts) {
        return std::any_of(texts.begin(), texts.end(),
                           [](const auto& each) { return shade::hasGlossOfLines(each.second); });
    };
    const std::string& text = object.material.brdf.empty() ? options.brdf : object.material.brdf;
    return shade::hasGlossOfLines(showsLines(options.prints) ? shade::withGlossOfLines(text) : text) ||
           any(object.material.each) || any(options.finishes);
}

MaterialPlan planMaterial(const ObjectOptions& object, const TracingOptions& options, AttributeNeeds& needs) {
    MaterialPlan plan{object.material, false, ""};
    if (plan.material.by.empty() && plan.material.brdf.empty() && !object.sdf) {
        plan.material.by = options.color_by;
        plan.material.range = options.color_range;
        plan.stated_colors = options.file_colors && plan.material.by.empty();
    }
    plan.by = plan.stated_colors ? "color" : plan.material.by;
    if (needsGrain(object, options)) needs.addGrain(object);
    if (plan.by.empty()) return plan;
    (void)needs.number(plan.by);
    if (plan.stated_colors)
        needs.addStatedColors(object);
    else
        needs.add(object, plan.by);
    return plan;
}

/// Why an attribute tells nothing apart, if its file says nothing of it; else nothing.
std::string_view lackOf(const std::string& by, const trace::AttributeSummary& summary) {
    const bool only_zero = summary.values == std::vector<int>{0};
    if (by == "feature" && only_zero)
        return "names no features (comments such as ;TYPE: say what is printed), so --color-by feature has one colour";
    if (by == "object" && only_zero) return "names no objects, so --color-by object has one colour";
    const auto stated = [](const glm::vec3& color) { return color != trace::kNoColor; };
    if (summary.kind == trace::AttributeSummary::Kind::color &&
        std::none_of(summary.colors.begin(), summary.colors.end(), stated))
        return "states no colour of its filament, so --color-by color has the default one";
    return {};
}

// Of an object that a scene has among others: messages name it.
Shape namedSdf(const ObjectOptions& object, std::size_t number, const TracingOptions& options) {
    try {
        return shapeOfSdf(object, options);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("objects[{}].sdf: {}", number, error.what()));
    }
}

/// Makes each shape once.
class ShapeReader {
public:
    ShapeReader(const TracingOptions& options, AttributeNeeds& needs)
        : options_(options), needs_(needs), warnings_(options.events) {}

    /// @param number  of the object in its scene
    const Shape& shapeOf(const ObjectOptions& object, std::size_t number, TracedObjects& result) {
        if (object.sdf) return keep(namedSdf(object, number, options_), result);
        auto& known = files_[{object.vdb, object.grid}];
        if (known != nullptr) return *known;
        const bool print = options_.prints.toolpath || !isVdbFile(object.vdb);
        if (print && !object.grid.empty())
            throw UsageError(
                fmt::format("{}: is G-code, which has no grid {}; leave the grid out", object.vdb, object.grid));
        known = &keep(print ? shapeOfPrint(object, options_, needs_, warnings_)
                            : shapeOfLevelSet(object, options_, needs_, warnings_),
                      result);
        return *known;
    }
    const std::vector<Warning>& warnings() const { return warnings_.all(); }
    /// Tells once of a file whose attribute does not color what it is asked to color.
    void tellUncolored(const ObjectOptions& object, const MaterialPlan& plan, const Shape& shape) {
        const auto summary = shape.summaries.find(plan.by);
        if (summary == shape.summaries.end() || !told_.insert({&shape, plan.by}).second) return;
        if (const std::string_view lack = lackOf(plan.by, summary->second); !lack.empty())
            warnings_.add(Warning::Kind::color_by, fmt::format("{}: {}", object.vdb, lack));
        if (options_.clip.empty() || shape.print) return;
        warnings_.add(
            Warning::Kind::color_by,
            fmt::format("{}: has values of {} near the surface alone; where --clip cuts deeper, {}. G-code "
                        "itself has them everywhere",
                        object.vdb, plan.by,
                        plan.material.each.empty() ? "the cut is grey" : "the cut has the material of others"));
    }

private:
    const Shape& keep(Shape shape, TracedObjects& result) {
        result.load_seconds += shape.load_seconds;
        result.build_seconds += shape.build_seconds;
        if (shape.print) result.prints.push_back(shape.print);
        shapes_.push_back(std::make_unique<Shape>(std::move(shape)));
        return *shapes_.back();
    }

    const TracingOptions& options_;
    AttributeNeeds& needs_;
    Warnings warnings_;
    std::vector<std::unique_ptr<Shape>> shapes_;
    std::map<std::pair<std::string, std::string>, const Shape*> files_;  // by path and grid
    std::set<std::pair<const Shape*, std::string>> told_;                // of an attribute
};

void addMaterial(const MaterialPlan& plan, const Shape& shape, AttributeNeeds& needs, ObjectMaterials& materials) {
    const auto summary = shape.summaries.find(plan.by);
    const trace::AttributeSummary* const known = summary == shape.summaries.end() ? nullptr : &summary->second;
    const std::size_t number = plan.by.empty() ? 0 : needs.number(plan.by);
    if (plan.stated_colors)
        materials.add(shape.colors, number, shape.colors.by_place ? known : nullptr);
    else
        materials.add(plan.material, number, plan.by.empty() ? nullptr : known);
}

// Reports of a shape; its line once, even if several objects use it.
void addFacts(const Shape& shape, TracedObjects& result) {
    result.reports.push_back(shape.report);
    if (!shape.source.empty()) result.source += " " + shape.source;
    if (std::find(result.lines.begin(), result.lines.end(), shape.line) == result.lines.end())
        result.lines.push_back(shape.line);
}

}  // namespace

TracedObjects readTracedObjects(const std::vector<ObjectOptions>& objects, const TracingOptions& options) {
    openvdb::initialize();
    TracedObjects result;
    result.reports = Json::array();
    AttributeNeeds needs;
    planLabels(objects, options, needs, result);
    std::vector<MaterialPlan> plans;
    plans.reserve(objects.size());
    for (const ObjectOptions& object : objects) plans.push_back(planMaterial(object, options, needs));

    ShapeReader reader(options, needs);
    ObjectMaterials materials(options.brdf, options.finishes, showsLines(options.prints));
    std::vector<trace::SceneObject> scene;
    std::optional<trace::Box> parts;
    bool any_part = false;
    bool any_outline = false;
    for (std::size_t n = 0; n < objects.size(); ++n) {
        const ObjectOptions& object = objects[n];
        const Shape& shape = reader.shapeOf(object, n, result);
        const bool y_up = object.up.empty() ? shape.y_up : object.up == "y";
        scene.push_back({shape.intersector, y_up ? upright(object.placement) : object.placement});
        include(parts, result.outline, shape, scene.back().placement);
        any_part = any_part || shape.part.has_value();
        any_outline = any_outline || !shape.outline.empty();
        if (n == 0) result.mm_per_unit = shape.mm_per_unit;
        addFacts(shape, result);
        addMaterial(plans[n], shape, needs, materials);
        reader.tellUncolored(object, plans[n], shape);
    }
    if (any_part) result.part = parts;
    if (!any_outline) result.outline.clear();
    result.materials = materials.materials();
    result.brdf = materials.brdf();
    result.brdfs = materials.brdfs();
    result.material_report = materials.report();
    result.legends = materials.legends();
    result.no_color_lookup = materials.noLookup();
    result.warnings = reader.warnings();
    result.intersector = trace::makeClipIntersector(trace::makeSceneIntersector(std::move(scene)), options.clip);
    return result;
}

Json onDemandReport(const TracedObjects& objects) {
    Json all = Json::array();
    for (const auto& print : objects.prints) all.push_back(print->report());
    return all;
}

std::shared_ptr<LazyPrint> growingPrint(const TracedObjects& objects) {
    const auto found = std::find_if(objects.prints.rbegin(), objects.prints.rend(),
                                    [](const auto& print) { return print->moments() > 1; });
    return found == objects.prints.rend() ? nullptr : *found;
}

}  // namespace stratum::assemble
