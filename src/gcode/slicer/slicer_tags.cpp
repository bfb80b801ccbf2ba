#include "gcode/slicer/slicer_tags.h"

#include "base/text.h"
#include "gcode/slicer/feature_names.h"
#include "gcode/text/limits.h"
#include "gcode/text/number.h"

#include <algorithm>

namespace stratum::gcode {
namespace {

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text = trim(text.substr(prefix.size()));
    return true;
}

constexpr double kMostHeight = 100;  // mm; a layer that is higher is a damaged number

// The positive number up to `most` at the start of the text, else 0.
double positive(std::string_view text, double most) {
    const char* p = text.data();
    double value = 0;
    return parseNumber(p, p + text.size(), value) && value > 0 && value <= most ? value : 0;
}

Tag ofHeight(std::string_view text) {
    const double height = positive(text, kMostHeight);
    return height > 0 ? Tag{.kind = Tag::Kind::height, .height = height} : Tag{};
}

Tag ofType(std::string_view text) {
    return {.kind = Tag::Kind::feature, .feature = featureOfType(text).value_or(Feature::unknown), .text = text};
}

Tag ofSegment(std::string_view text) {
    return {.kind = Tag::Kind::feature, .feature = featureOfSegment(text).value_or(Feature::unknown), .text = text};
}

// `mark`: the words that announce it.
Tag layerChange(std::string_view mark, double height = 0) {
    return {.kind = Tag::Kind::layer_change, .height = height, .text = mark};
}

// KISSlicer and Canvas: "BEGIN_LAYER_OBJECT z=0.2000 z_thickness=0.2000".
Tag ofBegunLayer(std::string_view text) {
    Tag tag = layerChange("BEGIN_LAYER_");
    const auto z = text.find(" z=");
    if (z != std::string_view::npos) tag.z = positive(text.substr(z + 3), kMaxCoordinate);
    return tag;
}

// Kiri:Moto: ";; --- layer 3 (0.200 @ 0.85) ---", height and z in the parentheses; or without these.
Tag ofKiriLayer(std::string_view text) {
    const auto height = text.find_first_not_of("0123456789");
    if (height == std::string_view::npos || text.find('@') == std::string_view::npos) return {};
    text = trim(text.substr(height));
    take(text, "(");
    return layerChange("--- layer", positive(text, kMostHeight));
}

// Simplify3D: "layer 3, Z = 0.600". "layer end" and prose are not. With several processes a layer is announced by each.
Tag ofNumberedLayer(std::string_view text) {
    const auto digits = text.find_first_not_of("0123456789");
    if (digits == 0 || digits == std::string_view::npos) return {};
    text.remove_prefix(digits);
    if (!take(text, ", Z =")) return {};
    Tag tag = layerChange("layer");
    tag.z = positive(text, kMaxCoordinate);
    return tag;
}

// Simplify3D: "tool H0.200 W0.450".
Tag ofToolShape(std::string_view text) { return take(text, "H") ? ofHeight(text) : Tag{}; }

// KISSlicer: "'Sparse Infill Path', 0.9 [feed mm/s], 52.5 [head mm/s]"; 1.1.0.5 and before: "'Sparse Infill', ...".
Tag ofPath(std::string_view text) {
    if (text.find("[feed mm/s]") == std::string_view::npos) return {};
    text.remove_prefix(1);
    text = text.substr(0, text.find('\''));
    if (text.ends_with(" Path")) text.remove_suffix(5);
    if (text.starts_with("Destring") || text.starts_with("Wipe")) return {};
    return {.kind = Tag::Kind::feature, .feature = featureOfPath(text).value_or(Feature::unknown), .text = text};
}

// Skeinforge: "<layer> 0.36 ", the number being the middle of the layer; IceSL: "<layer 3>".
Tag ofMarkup(std::string_view text) {
    if (text.starts_with("<layer>") || text.starts_with("<layer ")) {
        Tag tag = layerChange("<layer");
        // Of two tools each announces the layer.
        if (take(text, "<layer>")) tag.z = positive(text, kMaxCoordinate);
        return tag;
    }
    if (text.starts_with("<edge>") || text.starts_with("<perimeter>") || text.starts_with("<perimeterPath>"))
        return {.kind = Tag::Kind::feature, .feature = Feature::external_perimeter};
    if (text.starts_with("<loop>")) return {.kind = Tag::Kind::feature, .feature = Feature::perimeter};
    if (text.starts_with("<infill>")) return {.kind = Tag::Kind::feature, .feature = Feature::infill};
    if (text.starts_with("<supportLayer>")) return {.kind = Tag::Kind::feature, .feature = Feature::support};
    // Before it had a tag, what stands behind a line that is closed was infill.
    for (const std::string_view end :
         {"</edge>", "</perimeter>", "</perimeterPath>", "</boundaryPerimeter>", "</loop>"})
        if (text.starts_with(end)) return {.kind = Tag::Kind::feature, .feature = Feature::infill};
    for (const std::string_view end : {"</infill>", "</supportLayer>"})
        if (text.starts_with(end)) return {.kind = Tag::Kind::feature, .feature = Feature::unknown, .text = "unknown"};
    return {};
}

// PrusaSlicer and its kin: "COLOR_CHANGE,T0,#ED1C24"; before 2.3 without the color, which its preview then takes from a
// list. `text`: behind the name.
Tag ofColorChange(std::string_view text) {
    if (!text.empty() && text.front() != ',') return {};
    take(text, ",");
    Tag tag{.kind = Tag::Kind::color_change};
    if (text.starts_with('T') && text.size() > 1 && text[1] >= '0' && text[1] <= '9') {
        tag.tool = text[1] - '0';
        if (text.size() > 2 && text[2] >= '0' && text[2] <= '9') tag.tool = tag.tool * 10 + text[2] - '0';
    }
    const auto color = text.find('#');
    if (color != std::string_view::npos) tag.text = text.substr(color, 7);
    return tag;
}

// REALvision; MakerWare's slicer Miracle-Grue, behind each move: "Infill", where Cura's ";BRIDGE" is none. Its first
// version before several: "insets: 2", "inset path, length: 4".
constexpr std::string_view kMoveInitials = "BCIORSios";
Tag ofMoveComment(std::string_view text) {
    if (text.size() < 2 || text[1] < 'a' || text[1] > 'z') return {};
    if (const auto count = text.find(": "); count != std::string_view::npos)
        text = text.substr(0, std::min(count + 1, text.find(" path,")));
    const auto feature = featureOfMoveComment(text);
    return feature ? Tag{.kind = Tag::Kind::feature, .feature = *feature, .text = text, .bare = true} : Tag{};
}

Tag ofBareName(std::string_view text) {
    const auto feature = featureOfBareName(text);
    return feature ? Tag{.kind = Tag::Kind::feature, .feature = *feature, .text = text} : Tag{};
}

Tag ofObject(std::string_view name) { return {.kind = Tag::Kind::object_start, .text = name}; }

Tag ofFlush(std::string_view text) {
    if (text == "FLUSH_START") return {.kind = Tag::Kind::flush_start};
    return {.kind = text == "FLUSH_END" ? Tag::Kind::flush_stop : Tag::Kind::none};
}

Tag ofObjectEnd(std::string_view text) {
    take(text, ", ");
    return {.kind = Tag::Kind::object_stop, .text = text};
}

}  // namespace

Tag parseTag(std::string_view comment) {
    std::string_view text = trim(comment);
    if (text.empty()) return {};
    if (kMoveInitials.find(text.front()) != std::string_view::npos)
        if (const Tag tag = ofMoveComment(text); tag.kind != Tag::Kind::none) return tag;
    switch (text.front()) {
        case 'T':
            if (take(text, "TYPE:")) return ofType(text);
            break;
        case '<':
            return ofMarkup(text);
        case '(':  // IceSL: ";(<layer 3>)"
            return ofMarkup(text.substr(1));
        case '\'':
            return ofPath(text);
        case 'B':
            if (take(text, "BEGIN_LAYER_")) return ofBegunLayer(text);
            break;
        case 'P':  // ideaMaker
            if (take(text, "PRINTING:"))
                return text == "NON-OBJECT" ? Tag{.kind = Tag::Kind::object_stop} : ofObject(text);
            break;
        case 'F':
            if (take(text, "FEATURE:")) return ofType(text);
            return ofFlush(text);
        case 'f':  // Simplify3D from 4.1 on
            if (take(text, "feature ")) return ofBareName(text);
            break;
        case 'V':  // what Bambu's printers with two nozzles flush by themselves
            return ofFlush(text.substr(1));
        case 'H':
            if (take(text, "HEIGHT:")) return ofHeight(text);
            if (take(text, "HEIGHT-BELT:")) return ofHeight(text);  // ideaMaker: across the layers; HEIGHT is Z's
            break;
        case 'L':
            if (take(text, "LAYER_CHANGE")) return layerChange("LAYER_CHANGE");
            if (take(text, "LAYER_HEIGHT:")) return ofHeight(text);
            if (take(text, "LAYER:")) {
                Tag tag = layerChange("LAYER:");
                tag.raft = text.starts_with('-');
                return tag;
            }
            break;
        case 'C':
            if (take(text, "CHANGE_LAYER")) return layerChange("CHANGE_LAYER");
            if (text.starts_with("CP TOOLCHANGE WIPE")) return {.kind = Tag::Kind::filament_loaded};
            if (take(text, "COLOR_CHANGE")) return ofColorChange(text);
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
            if (take(text, "start printing object, ")) return ofObject(text);
            if (take(text, "segType:")) return ofSegment(text);
            if (text.starts_with("set units to ")) return {.kind = Tag::Kind::units_set};
            if (take(text, "stop printing object")) return ofObjectEnd(text);
            break;
        default:
            break;
    }
    constexpr std::size_t kLongestBareName = 26;
    const bool may = text.size() <= kLongestBareName && text.front() >= 'a' && text.front() <= 'z';
    if (!may) return {};
    Tag tag = ofBareName(text);
    tag.bare = tag.kind == Tag::Kind::feature;
    return tag;
}

bool isPlainLayerMark(std::string_view comment) {
    std::string_view text = trim(comment);
    if (!take(text, "layer")) return false;
    return trim(text).find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace stratum::gcode
