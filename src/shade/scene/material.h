// The material of an object: one BRDF, or several that are selected by an attribute.
#pragma once

#include "shade/brdf/brdf.h"
#include "shade/color.h"
#include "shade/film/legend.h"
#include "trace/attribute.h"

#include <glm/vec3.hpp>

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace stratum::shade {

/// The description of an object's material.
struct MaterialOptions {
    std::string brdf;  ///< see makeBrdf; empty: the scene's. With `by`: for values that are not in `each`
    std::string by;    ///< name of the attribute that selects; empty: one material
    std::optional<std::array<double, 2>> range;  ///< values at the ends of a ramp; empty: the least and the most
    std::map<std::string, std::string>
        each;  ///< value, its name, or "#rrggbb" of a color -> see makeBrdf; empty: `brdf` in a palette's colors
};

/// A BRDF and its color.
struct Material {
    std::shared_ptr<const Brdf> brdf;
    Color albedo{0.0f};                ///< its reflectanceFactor
    bool by_place = false;             ///< its variesByPlace
    const Brdf* undirected = nullptr;  ///< its undirected(); null for nearly all
};

/// Immutable; shared by all threads.
class ObjectMaterial {
public:
    explicit ObjectMaterial(std::shared_ptr<const Brdf> brdf);
    /// @param attribute  number of the attribute, see Tracer::attribute()
    /// @param brdfs      at least two: the first for values that choose none, the last for points without a value, and
    ///                   for values that are not finite
    /// @param choose     finite value -> index into brdfs
    /// @param filaments  the values are the colors of filaments
    ObjectMaterial(std::size_t attribute, const std::vector<std::shared_ptr<const Brdf>>& brdfs,
                   std::function<std::size_t(const glm::vec3&)> choose, bool filaments = false);

    bool single() const { return !choose_; }
    /// The materials that show what the object is made of: the only one, or those of its filaments. None where colors
    /// stand for other values, such as features or speeds.
    std::span<const Material> ofPlastic() const {
        if (single()) return materials_;
        return filaments_ ? std::span(materials_).subspan(1, materials_.size() - 2) : std::span<const Material>();
    }
    /// Whether light goes through one of them.
    bool anyTranslucent() const;
    /// Whether one of them is another one at other places.
    bool anyByPlace() const;
    std::size_t attribute() const { return attribute_; }
    const Material& only() const { return materials_.front(); }
    const Material& of(const std::optional<glm::vec3>& value) const {
        return value && isFinite(*value) ? materials_[choose_(*value)] : materials_.back();
    }

private:
    std::size_t attribute_ = 0;
    std::vector<Material> materials_;
    std::function<std::size_t(const glm::vec3&)> choose_;
    bool filaments_ = false;
};

/// The material of `options` for an object whose attribute `options.by` has this number and summary.
/// With `each`: those materials; of colors, the others are as without. Without: `brdf` (or `scene_brdf`) in other
/// colors: those of the attribute itself if its values are colors, of a palette for up to 32 whole numbers (features
/// have fixed colors), else of a ramp from the least value to the most, from blue over white to red if they are
/// opposite; gray where there is no value, or one that is not finite. Throws UsageError: a BRDF without a body color (a
/// table), a name that the attribute doesn't have.
ObjectMaterial makeObjectMaterial(const MaterialOptions& options, const std::string& scene_brdf, std::size_t attribute,
                                  const trace::AttributeSummary& summary);

/// The legend of that material's colors: the attribute's values, or its ramp, whose unit the caller knows.
Legend makeLegend(const MaterialOptions& options, const trace::AttributeSummary& summary,
                  const ObjectMaterial& material);

/// The n-th of a set of clearly distinct colors; they repeat. Linear RGB.
Color categoryColor(std::size_t n);
/// A ramp from dark blue (0) through green to yellow (1) of increasing lightness. Linear RGB.
Color rampColor(double t);
/// A ramp from blue (0) over white to red (1), for values about zero. Linear RGB.
Color divergingColor(double t);

}  // namespace stratum::shade
