#include "gcode/slicer/feature_names.h"

#include "base/text.h"

#include <initializer_list>
#include <string>
#include <unordered_map>

namespace stratum::gcode {
namespace {

// A feature and its names in lower case, between bars.
struct NamedFeature {
    Feature feature;
    std::string_view texts;
};

class FeatureNames {
public:
    FeatureNames(std::initializer_list<NamedFeature> list) {
        for (const NamedFeature& names : list)
            for (const std::string_view name : split(names.texts, '|')) features_.emplace(name, names.feature);
    }
    std::optional<Feature> find(std::string_view text) const {
        const auto found = features_.find(lowerCase(std::string(text)));
        return found == features_.end() ? std::nullopt : std::optional(found->second);
    }

private:
    std::unordered_map<std::string_view, Feature> features_;
};

// Names behind ";TYPE:" and similar tags. One list for all slicers, since a name means the same in all
// of them: PrusaSlicer, SuperSlicer, CreatWare, Canvas, fiberslice, Cura, ideaMaker, OrcaSlicer, BambuStudio,
// MatterSlice.
const FeatureNames kFeatureTypes{
    {Feature::perimeter, "perimeter|internal perimeter|inner perimeter|wall inner|wall-inner|inner wall"},
    {Feature::external_perimeter, "external perimeter|thin wall|wall outer|wall-outer|outer wall|outline"},
    {Feature::overhang_perimeter, "overhang perimeter|bridge-wall|overhang|overhang wall"},
    {Feature::infill, "internal infill|infill|fill|sparse infill"},
    {Feature::solid_infill,
     "solid infill|skin|solid-fill|internal solid infill|bottom surface|floating vertical shell|ensure vertical "
     "shell|bottom-fill"},
    {Feature::top_infill, "top solid infill|top-surface|top surface|top-fill"},
    {Feature::bridge, "bridge infill|internal bridge infill|bridging|bridge|internal bridge"},
    {Feature::gap_fill, "gap fill|gap-fill|gap infill"},
    {Feature::ironing, "ironing|support ironing"},
    {Feature::skirt, "skirt|skirt/brim|brim/skirt"},
    {Feature::brim, "brim"},
    {Feature::support, "support material|support|support-infill|raft|support transition"},
    {Feature::support_interface, "support material interface|support-interface|support interface|air-gap"},
    {Feature::wipe_tower, "wipe tower|prime-tower|ooze-shield|wipe-tower|prime tower"},
    {Feature::custom, "custom"},
    {Feature::unknown, "mixed|unknown|travel|milling|multiple|undefined"},
};

// Whole comments of Slic3r (behind each move), Simplify3D (a line of their own), Kiri:Moto of Lychee and IceSL.
const FeatureNames kBareNames{
    {Feature::perimeter, "perimeter|inner perimeter|internal single extrusion|single extrusion|shells|shell"},
    {Feature::external_perimeter, "external perimeter|outer perimeter|external single extrusion"},
    {Feature::overhang_perimeter, "overhang perimeter"},
    {Feature::infill, "infill"},
    {Feature::solid_infill, "solid infill|solid layer|cover"},
    {Feature::top_infill, "top solid infill|curved cover"},
    {Feature::bridge, "bridge"},
    {Feature::gap_fill, "gap fill|gap"},
    {Feature::skirt, "skirt"},
    {Feature::brim, "brim"},
    {Feature::support, "raft|support|support material"},
    {Feature::support_interface, "dense support|support material interface"},
    {Feature::wipe_tower, "prime pillar|ooze shield|shield|tower"},
};

// Capitalised comments of Miracle-Grue and, the last, REALvision.
const FeatureNames kMoveComments{
    {Feature::external_perimeter, "outline|outlines:|contour"},
    {Feature::perimeter, "inset|insets:"},
    {Feature::infill, "infill|infills:"},
    {Feature::support, "support|raft"},
    {Feature::bridge, "bridge"},
    {Feature::gap_fill, "spur"},
};

// CraftWare's ";segType:", which IceSL can write too.
const FeatureNames kSegmentNames{
    {Feature::external_perimeter, "perimeter"},
    {Feature::perimeter, "loop"},
    {Feature::solid_infill, "hshell"},
    {Feature::infill, "infill"},
    {Feature::gap_fill, "innerhair|outerhair"},
    {Feature::skirt, "skirt"},
    {Feature::support, "raft|support"},
    {Feature::support_interface, "softsupport|supporttouch"},
    {Feature::wipe_tower, "pillar"},
    {Feature::unknown, "travel"},
};

// KISSlicer's "'Sparse Infill Path'". Paths without extrusion (Destring/Wipe/Jump) are no features.
const FeatureNames kPathNames{
    {Feature::external_perimeter, "perimeter"},
    {Feature::perimeter, "loop"},
    {Feature::gap_fill, "crown"},
    {Feature::solid_infill, "solid"},
    {Feature::infill, "sparse infill|stacked sparse infill"},
    {Feature::support, "support (may stack)|raft"},
    {Feature::support_interface, "support interface"},
    {Feature::skirt, "skirt"},
    {Feature::wipe_tower, "pillar|prime pillar"},
    {Feature::ironing, "travel/ironing"},
};

}  // namespace

std::optional<Feature> featureOfType(std::string_view name) { return kFeatureTypes.find(name); }
std::optional<Feature> featureOfBareName(std::string_view name) { return kBareNames.find(name); }
std::optional<Feature> featureOfMoveComment(std::string_view name) { return kMoveComments.find(name); }
std::optional<Feature> featureOfSegment(std::string_view name) { return kSegmentNames.find(name); }
std::optional<Feature> featureOfPath(std::string_view name) { return kPathNames.find(name); }

}  // namespace stratum::gcode
