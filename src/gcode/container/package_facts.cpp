#include "gcode/container/package_facts.h"

#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMostFilaments = 256;
constexpr std::size_t kMostName = 200;  // bytes
constexpr std::size_t kMostTag = 4096;  // bytes

std::string unescape(std::string_view text) {
    using Entity = std::pair<std::string_view, char>;
    constexpr std::array kEntities{Entity{"&quot;", '"'}, Entity{"&apos;", '\''}, Entity{"&lt;", '<'},
                                   Entity{"&gt;", '>'}, Entity{"&amp;", '&'}};
    std::string plain;
    while (!text.empty()) {
        const auto* entity = std::find_if(kEntities.begin(), kEntities.end(),
                                          [text](const auto& one) { return text.starts_with(one.first); });
        const bool known = entity != kEntities.end();
        plain += known ? entity->second : text.front();
        text.remove_prefix(known ? entity->first.size() : 1);
    }
    // Names must be single lines in messages and metadata.
    std::replace_if(
        plain.begin(), plain.end(), [](char c) { return c == '\n' || c == '\r' || c == '\0'; }, ' ');
    return plain;
}

// The value of an attribute in a tag's text; empty if it has none.
std::string_view attribute(std::string_view tag, std::string_view name) {
    for (auto at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
        const std::string_view rest = tag.substr(at + name.size());
        if (at == 0 || tag[at - 1] != ' ' || !rest.starts_with("=\"")) continue;
        return rest.substr(2, rest.find('"', 2) - 2);
    }
    return {};
}

// Each tag of that name between '<' and '>'.
template <typename Take>
void forTags(std::string_view xml, std::string_view name, const Take& take) {
    const std::string opening = fmt::format("<{} ", name);
    for (auto at = xml.find(opening); at != std::string_view::npos; at = xml.find(opening, at)) {
        const std::size_t end = xml.substr(at, kMostTag).find('>');
        if (end != std::string_view::npos) take(xml.substr(at + 1, end - 1));
        at += end != std::string_view::npos ? end : opening.size();
    }
}

std::string_view between(std::string_view xml, std::string_view open, std::string_view close) {
    const auto start = xml.find(open);
    if (start == std::string_view::npos) return {};
    xml.remove_prefix(start + open.size());
    const auto end = xml.find(close);
    return end == std::string_view::npos ? std::string_view{} : xml.substr(0, end);
}

std::string_view metadata(std::string_view plate, std::string_view key) {
    std::string_view found;
    forTags(plate, "metadata", [&](std::string_view tag) {
        if (attribute(tag, "key") == key) found = attribute(tag, "value");
    });
    return found;
}

std::optional<double> positive(std::string_view text) {
    const auto value = parseDuration(text);
    return value && *value > 0 ? value : std::nullopt;
}

// The <plate> whose index is `number`.
std::string_view plateOf(std::string_view xml, int number) {
    while (!xml.empty()) {
        const std::string_view plate = between(xml, "<plate>", "</plate>");
        if (plate.empty()) return {};
        if (metadata(plate, "index") == fmt::format("{}", number)) return plate;
        xml.remove_prefix(static_cast<std::size_t>(plate.data() + plate.size() - xml.data()));
    }
    return {};
}

}  // namespace

PackageFacts readSliceInfo(std::string_view xml, int plate) {
    const std::string_view here = plateOf(xml, plate);
    PackageFacts facts;
    facts.stated.seconds = positive(metadata(here, "prediction"));
    facts.stated.grams = positive(metadata(here, "weight"));
    facts.stated.printer = unescape(metadata(here, "printer_model_id"));
    forTags(here, "object", [&](std::string_view tag) {
        const std::string_view id = attribute(tag, "identify_id");
        const std::string_view name = attribute(tag, "name");
        if (!id.empty() && !name.empty()) facts.object_names.emplace_back(id, unescape(name));
    });
    forTags(here, "filament", [&](std::string_view tag) {
        const std::size_t number = parsed<std::size_t>(attribute(tag, "id")).value_or(0);
        if (number == 0 || number > kMostFilaments) return;
        if (facts.filament_colors.size() < number) facts.filament_colors.resize(number);
        if (facts.stated.materials.size() < number) facts.stated.materials.resize(number);
        facts.filament_colors[number - 1] = parseColor(attribute(tag, "color"));
        facts.stated.materials[number - 1] = unescape(attribute(tag, "type"));
    });
    return facts;
}

std::vector<std::string> materialPaths(std::string_view xml) {
    std::vector<std::string> paths;
    forTags(xml, "Relationship", [&](std::string_view tag) {
        std::string_view target = attribute(tag, "Target");
        if (!attribute(tag, "Type").ends_with("/material") || paths.size() >= kMostFilaments) return;
        if (target.starts_with('/')) target.remove_prefix(1);
        paths.emplace_back(target);
    });
    return paths;
}

Material readMaterial(std::string_view xml) {
    return {unescape(between(xml, "<material>", "</material>").substr(0, kMostName)),
            parseColor(between(xml, "<color_code>", "</color_code>"))};
}

}  // namespace stratum::gcode
