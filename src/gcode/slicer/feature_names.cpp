#include "gcode/slicer/feature_names.h"

#include "base/text.h"

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

struct Name {
    std::string_view text;  // lower case
    Feature feature;
};

// Names behind ";TYPE:" and similar tags. One list for all slicers: a name means the same in all of them.
constexpr std::array kFeatureTypes{
    // PrusaSlicer, SuperSlicer
    Name{"perimeter", Feature::perimeter},
    Name{"internal perimeter", Feature::perimeter},
    Name{"external perimeter", Feature::external_perimeter},
    Name{"overhang perimeter", Feature::overhang_perimeter},
    Name{"thin wall", Feature::external_perimeter},
    Name{"internal infill", Feature::infill},
    Name{"solid infill", Feature::solid_infill},
    Name{"top solid infill", Feature::top_infill},
    Name{"bridge infill", Feature::bridge},
    Name{"internal bridge infill", Feature::bridge},
    Name{"gap fill", Feature::gap_fill},
    Name{"ironing", Feature::ironing},
    Name{"skirt", Feature::skirt},
    Name{"skirt/brim", Feature::skirt},
    Name{"brim", Feature::brim},
    Name{"support material", Feature::support},
    Name{"support material interface", Feature::support_interface},
    Name{"wipe tower", Feature::wipe_tower},
    Name{"custom", Feature::custom},
    Name{"mixed", Feature::unknown},
    Name{"unknown", Feature::unknown},
    Name{"travel", Feature::unknown},
    Name{"milling", Feature::unknown},
    // CreatWare
    Name{"inner perimeter", Feature::perimeter},
    // Mosaic's Canvas, fiberslice
    Name{"wall outer", Feature::external_perimeter},
    Name{"wall inner", Feature::perimeter},
    Name{"infill", Feature::infill},
    Name{"bridging", Feature::bridge},
    Name{"brim/skirt", Feature::skirt},
    // Cura
    Name{"wall-outer", Feature::external_perimeter},
    Name{"wall-inner", Feature::perimeter},
    Name{"skin", Feature::solid_infill},
    Name{"fill", Feature::infill},
    Name{"support", Feature::support},
    Name{"support-interface", Feature::support_interface},
    Name{"prime-tower", Feature::wipe_tower},
    Name{"support-infill", Feature::support},
    Name{"bridge-wall", Feature::overhang_perimeter},
    // ideaMaker
    Name{"solid-fill", Feature::solid_infill},
    Name{"top-surface", Feature::top_infill},
    Name{"gap-fill", Feature::gap_fill},
    Name{"bridge", Feature::bridge},
    Name{"raft", Feature::support},
    Name{"overhang", Feature::overhang_perimeter},
    Name{"ooze-shield", Feature::wipe_tower},
    Name{"wipe-tower", Feature::wipe_tower},
    // OrcaSlicer, BambuStudio
    Name{"inner wall", Feature::perimeter},
    Name{"outer wall", Feature::external_perimeter},
    Name{"overhang wall", Feature::overhang_perimeter},
    Name{"sparse infill", Feature::infill},
    Name{"internal solid infill", Feature::solid_infill},
    Name{"bottom surface", Feature::solid_infill},
    Name{"top surface", Feature::top_infill},
    Name{"internal bridge", Feature::bridge},
    Name{"gap infill", Feature::gap_fill},
    Name{"support interface", Feature::support_interface},
    Name{"support transition", Feature::support},
    Name{"prime tower", Feature::wipe_tower},
    Name{"support ironing", Feature::ironing},
    Name{"floating vertical shell", Feature::solid_infill},
    Name{"ensure vertical shell", Feature::solid_infill},
    Name{"multiple", Feature::unknown},
    Name{"undefined", Feature::unknown},
};

// Whole comments of Slic3r (behind each move) and Simplify3D (a line of their own).
constexpr std::array kBareNames{
    Name{"perimeter", Feature::perimeter},
    Name{"inner perimeter", Feature::perimeter},
    Name{"external perimeter", Feature::external_perimeter},
    Name{"outer perimeter", Feature::external_perimeter},
    Name{"overhang perimeter", Feature::overhang_perimeter},
    Name{"external single extrusion", Feature::external_perimeter},
    Name{"internal single extrusion", Feature::perimeter},
    Name{"infill", Feature::infill},
    Name{"solid infill", Feature::solid_infill},
    Name{"solid layer", Feature::solid_infill},
    Name{"top solid infill", Feature::top_infill},
    Name{"bridge", Feature::bridge},
    Name{"gap fill", Feature::gap_fill},
    Name{"skirt", Feature::skirt},
    Name{"brim", Feature::brim},
    Name{"raft", Feature::support},
    Name{"support", Feature::support},
    Name{"dense support", Feature::support_interface},
    Name{"support material", Feature::support},
    Name{"support material interface", Feature::support_interface},
    Name{"prime pillar", Feature::wipe_tower},
    Name{"ooze shield", Feature::wipe_tower},
    Name{"single extrusion", Feature::perimeter},
    Name{"gap", Feature::gap_fill},
    // Kiri:Moto of Lychee
    Name{"shells", Feature::perimeter},
    // IceSL's own words
    Name{"shell", Feature::perimeter},
    Name{"cover", Feature::solid_infill},
    Name{"curved cover", Feature::top_infill},
    Name{"shield", Feature::wipe_tower},
    Name{"tower", Feature::wipe_tower},
};

// Capitalised comments of Miracle-Grue and, the last, REALvision.
constexpr std::array kMoveComments{
    Name{"outline", Feature::external_perimeter},
    Name{"inset", Feature::perimeter},
    Name{"infill", Feature::infill},
    Name{"support", Feature::support},
    Name{"raft", Feature::support},
    Name{"bridge", Feature::bridge},
    Name{"spur", Feature::gap_fill},
    Name{"outlines:", Feature::external_perimeter},
    Name{"insets:", Feature::perimeter},
    Name{"infills:", Feature::infill},
    Name{"contour", Feature::external_perimeter},
};

// CraftWare's ";segType:", which IceSL can write too.
constexpr std::array kSegmentNames{
    Name{"perimeter", Feature::external_perimeter},
    Name{"loop", Feature::perimeter},
    Name{"hshell", Feature::solid_infill},
    Name{"infill", Feature::infill},
    Name{"innerhair", Feature::gap_fill},
    Name{"outerhair", Feature::gap_fill},
    Name{"skirt", Feature::skirt},
    Name{"raft", Feature::support},
    Name{"support", Feature::support},
    Name{"softsupport", Feature::support_interface},
    Name{"supporttouch", Feature::support_interface},
    Name{"pillar", Feature::wipe_tower},
    Name{"travel", Feature::unknown},
};

// KISSlicer's "'Sparse Infill Path'". Paths without extrusion (Destring/Wipe/Jump) are no features.
constexpr std::array kPathNames{
    Name{"perimeter", Feature::external_perimeter},
    Name{"loop", Feature::perimeter},
    Name{"crown", Feature::gap_fill},
    Name{"solid", Feature::solid_infill},
    Name{"sparse infill", Feature::infill},
    Name{"stacked sparse infill", Feature::infill},
    Name{"support (may stack)", Feature::support},
    Name{"support interface", Feature::support_interface},
    Name{"raft", Feature::support},
    Name{"skirt", Feature::skirt},
    Name{"pillar", Feature::wipe_tower},
    Name{"prime pillar", Feature::wipe_tower},
    Name{"travel/ironing", Feature::ironing},
};

template <std::size_t n>
std::optional<Feature> lookUp(const std::array<Name, n>& names, std::string_view text) {
    const auto same = [&](const Name& name) {
        return std::equal(name.text.begin(), name.text.end(), text.begin(), text.end(),
                          [](char a, char b) { return a == lowerCase(b); });
    };
    const auto found = std::find_if(names.begin(), names.end(), same);
    return found == names.end() ? std::nullopt : std::optional(found->feature);
}

}  // namespace

std::optional<Feature> featureOfType(std::string_view name) { return lookUp(kFeatureTypes, name); }
std::optional<Feature> featureOfBareName(std::string_view name) { return lookUp(kBareNames, name); }
std::optional<Feature> featureOfMoveComment(std::string_view name) { return lookUp(kMoveComments, name); }
std::optional<Feature> featureOfSegment(std::string_view name) { return lookUp(kSegmentNames, name); }
std::optional<Feature> featureOfPath(std::string_view name) { return lookUp(kPathNames, name); }

}  // namespace stratum::gcode
