#include "gcode/slicer_tags.h"

#include "gcode/number.h"

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

struct Name {
    std::string_view text;  // lower case
    Feature feature;
};

// Names behind ";TYPE:" and its kin. One list for all slicers: where two use one word, they mean the same thing.
constexpr std::array kTypeNames{
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
    // Cura
    Name{"wall-outer", Feature::external_perimeter},
    Name{"wall-inner", Feature::perimeter},
    Name{"skin", Feature::solid_infill},
    Name{"fill", Feature::infill},
    Name{"support", Feature::support},
    Name{"support-interface", Feature::support_interface},
    Name{"prime-tower", Feature::wipe_tower},
    // ideaMaker
    Name{"solid-fill", Feature::solid_infill},
    Name{"gap-fill", Feature::gap_fill},
    Name{"bridge", Feature::bridge},
    Name{"raft", Feature::support},
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
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c; }

template <std::size_t n>
std::optional<Feature> lookUp(const std::array<Name, n>& names, std::string_view text) {
    const auto same = [&](const Name& name) {
        return std::equal(name.text.begin(), name.text.end(), text.begin(), text.end(),
                          [](char a, char b) { return a == lower(b); });
    };
    const auto found = std::find_if(names.begin(), names.end(), same);
    return found == names.end() ? std::nullopt : std::optional(found->feature);
}

std::string_view trim(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text = trim(text.substr(prefix.size()));
    return true;
}

// The positive number at the start of the text, else 0.
double positive(std::string_view text) {
    const char* p = text.data();
    double value = 0;
    return parseNumber(p, p + text.size(), value) && value > 0 ? value : 0;
}

Tag ofHeight(std::string_view text) {
    const double height = positive(text);
    return height > 0 ? Tag{.kind = Tag::Kind::height, .height = height} : Tag{};
}

Tag ofType(std::string_view text) {
    return {.kind = Tag::Kind::feature, .feature = featureOfSlicerName(text).value_or(Feature::unknown), .text = text};
}

Tag layerChange(double height = 0) { return {.kind = Tag::Kind::layer_change, .height = height}; }

// Kiri:Moto: ";; --- layer 3 (0.200 @ 0.85) ---", height and z in the parentheses.
Tag ofKiriLayer(std::string_view text) {
    const auto open = text.find('(');
    if (open == std::string_view::npos || text.find('@') == std::string_view::npos) return {};
    return layerChange(positive(text.substr(open + 1)));
}

// Simplify3D: "layer 3, Z = 0.600". "layer end" and prose are not. With several processes a layer is announced by each.
Tag ofNumberedLayer(std::string_view text) {
    const auto digits = text.find_first_not_of("0123456789");
    if (digits == 0 || digits == std::string_view::npos) return {};
    text.remove_prefix(digits);
    if (!take(text, ", Z =")) return {};
    Tag tag = layerChange();
    tag.z = positive(text);
    return tag;
}

// Simplify3D: "tool H0.200 W0.450".
Tag ofToolShape(std::string_view text) { return take(text, "H") ? ofHeight(text) : Tag{}; }

Tag ofObject(std::string_view name) { return {.kind = Tag::Kind::object_start, .text = name}; }

}  // namespace

std::optional<Feature> featureOfSlicerName(std::string_view name) { return lookUp(kTypeNames, trim(name)); }

Tag parseTag(std::string_view comment) {
    std::string_view text = trim(comment);
    if (text.empty()) return {};
    switch (text.front()) {
        case 'T':
            if (take(text, "TYPE:")) return ofType(text);
            break;
        case 'F':
            if (take(text, "FEATURE:")) return ofType(text);
            break;
        case 'H':
            if (take(text, "HEIGHT:")) return ofHeight(text);
            break;
        case 'L':
            if (take(text, "LAYER_CHANGE")) return layerChange();
            if (take(text, "LAYER_HEIGHT:")) return ofHeight(text);
            if (take(text, "LAYER:")) return layerChange();
            break;
        case 'C':
            if (take(text, "CHANGE_LAYER")) return layerChange();
            break;
        case 'M':
            if (take(text, "MESH:")) return text == "NONMESH" ? Tag{.kind = Tag::Kind::object_stop} : ofObject(text);
            break;
        case ';':
            if (take(text, "; --- layer ")) return ofKiriLayer(text);
            break;
        case 'l':
            if (take(text, "layer ")) return ofNumberedLayer(text);
            break;
        case 't':
            if (take(text, "tool ")) return ofToolShape(text);
            break;
        case 'p':
            if (take(text, "printing object ")) return ofObject(text);
            break;
        case 's':
            if (take(text, "stop printing object")) return {.kind = Tag::Kind::object_stop};
            break;
        default:
            break;
    }
    constexpr std::size_t kLongestBareName = 26;
    if (text.size() <= kLongestBareName && text.front() >= 'a' && text.front() <= 'z')
        if (const auto feature = lookUp(kBareNames, text))
            return {.kind = Tag::Kind::feature, .feature = *feature, .text = text};
    return {};
}

}  // namespace stratum::gcode
