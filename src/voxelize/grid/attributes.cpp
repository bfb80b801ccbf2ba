#include "voxelize/grid/attributes.h"

#include "base/error.h"
#include "base/names.h"
#include "base/srgb.h"
#include "base/text.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/summary.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/estimate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace stratum::voxelize {
namespace {

constexpr float kGrey = 0.8f;

// IEC 61966-2-1, by a table, because every voxel needs a color.
float linear(std::uint8_t srgb) {
    static const std::array<float, 256> kTable = [] {
        std::array<float, 256> table{};
        for (std::size_t n = 0; n < table.size(); ++n) {
            table[n] = static_cast<float>(linearOfSrgb(static_cast<double>(n) / 255));
        }
        return table;
    }();
    return kTable[srgb];
}

openvdb::Vec3f linearOf(const std::optional<gcode::Rgb>& srgb) {
    if (!srgb) return openvdb::Vec3f(kGrey);
    return {linear((*srgb)[0]), linear((*srgb)[1]), linear((*srgb)[2])};
}

// By bead. A mixing hot end may change its color in every layer, and a search through all changes for each voxel would
// take longer than the voxels.
std::vector<openvdb::Vec3f> colorsOfBeads(const gcode::Toolpath& toolpath) {
    std::array<openvdb::Vec3f, 256> of_tool;
    for (std::size_t tool = 0; tool < of_tool.size(); ++tool)
        of_tool[tool] = linearOf(tool < toolpath.tool_colors.size() ? toolpath.tool_colors[tool] : std::nullopt);
    std::vector<openvdb::Vec3f> colors;
    colors.reserve(toolpath.beads.size());
    auto change = toolpath.color_changes.begin();
    for (std::size_t bead = 0; bead < toolpath.beads.size(); ++bead) {
        for (; change != toolpath.color_changes.end() && change->first_bead <= bead; ++change)
            of_tool[change->tool] = linearOf(change->color);
        colors.push_back(of_tool[toolpath.runOf(toolpath.beads[bead]).tool]);
    }
    return colors;
}

// By bead: the value of its tool, or of all tools, that was set last. What is used before its own was set has the first
// one that is set, or `before`.
std::vector<float> valuesOfBeads(const gcode::Toolpath& toolpath, const std::vector<gcode::SetValue>& set, bool by_tool,
                                 std::string_view what, std::optional<float> before = std::nullopt) {
    if (set.empty())
        throw InputError(
            fmt::format("the program never sets {}; print start macros may do so where no file tells it; "
                        "choose another attribute",
                        what));
    std::array<float, 256> of_tool{};
    of_tool.fill(before.value_or(set.front().value));
    for (auto first = set.rbegin(); by_tool && first != set.rend(); ++first) of_tool[first->tool] = first->value;
    std::vector<float> values;
    values.reserve(toolpath.beads.size());
    auto next = set.begin();
    for (const gcode::Bead& bead : toolpath.beads) {
        const std::uint32_t line = toolpath.lineOf(bead);
        for (; next != set.end() && next->line <= line; ++next) of_tool[next->tool] = next->value;
        values.push_back(of_tool[by_tool ? toolpath.runOf(bead).tool : 0]);
    }
    return values;
}

// The functions below give a value of each bead.

// What `value` makes of each bead's number.
template <typename Value>
std::vector<float> ofBeads(const gcode::Toolpath& toolpath, const Value& value) {
    std::vector<float> values(toolpath.beads.size());
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(value(n));
    return values;
}

std::vector<float> starts(const gcode::Toolpath& toolpath) {
    if (!toolpath.timing.empty())
        return ofBeads(toolpath, [&](std::size_t bead) { return toolpath.timing[bead].start; });
    double time = 0;
    return ofBeads(toolpath, [&](std::size_t bead) {
        return std::exchange(time, time + gcode::beadSeconds(toolpath, toolpath.beads[bead]));
    });
}

std::vector<float> widths(const gcode::Toolpath& toolpath) {
    return ofBeads(toolpath,
                   [&](std::size_t bead) { return 2 * sectionOf(toolpath, toolpath.beads[bead]).halfWidth(); });
}

std::vector<float> heights(const gcode::Toolpath& toolpath) {
    return ofBeads(toolpath, [&](std::size_t bead) { return toolpath.runOf(toolpath.beads[bead]).height; });
}

float speedOf(const gcode::Toolpath& toolpath, std::size_t bead) {
    const float seconds = toolpath.timing.empty() ? 0 : toolpath.timing[bead].seconds;
    if (!(seconds > 0)) return toolpath.runOf(toolpath.beads[bead]).speed;
    return static_cast<float>(gcode::beadLength(toolpath, toolpath.beads[bead])) / seconds;
}

std::vector<float> speeds(const gcode::Toolpath& toolpath) {
    return ofBeads(toolpath, [&](std::size_t bead) { return speedOf(toolpath, bead); });
}

std::vector<float> flows(const gcode::Toolpath& toolpath) {
    if (!toolpath.flow.empty()) return ofBeads(toolpath, [&](std::size_t bead) { return toolpath.flow[bead].rate; });
    return ofBeads(toolpath, [&](std::size_t n) {
        const gcode::Bead& bead = toolpath.beads[n];
        const double area =
            gcode::sectionArea(static_cast<double>(bead.width), static_cast<double>(toolpath.runOf(bead).height));
        return static_cast<float>(area) * speedOf(toolpath, n);
    });
}

std::vector<float> layerTimes(const gcode::Toolpath& toolpath) {
    const std::vector<double> seconds = gcode::layerSeconds(toolpath);
    return ofBeads(toolpath, [&](std::size_t bead) { return seconds[toolpath.runOf(toolpath.beads[bead]).layer]; });
}

std::vector<float> temperatures(const gcode::Toolpath& toolpath) {
    return valuesOfBeads(toolpath, toolpath.temperatures, true, "a temperature of a nozzle");
}

std::vector<float> fans(const gcode::Toolpath& toolpath) {
    return valuesOfBeads(toolpath, toolpath.fans, false, "a fan", 0.0F);  // off until then
}

std::vector<float> accelerations(const gcode::Toolpath& toolpath) {
    return valuesOfBeads(toolpath, toolpath.accelerations, false, "an acceleration");
}

std::vector<float> pressureAdvances(const gcode::Toolpath& toolpath) {
    return valuesOfBeads(toolpath, toolpath.pressure_advances, true, "a pressure advance");
}

std::int32_t layerOf(const gcode::Run& run) { return static_cast<std::int32_t>(run.layer); }
std::int32_t featureOf(const gcode::Run& run) { return static_cast<std::int32_t>(run.feature); }
std::int32_t toolOf(const gcode::Run& run) { return run.tool; }
std::int32_t objectOf(const gcode::Run& run) { return run.object; }

// All that is known of an attribute; a new one is a line here, and its place in the enum.
struct Facts {
    std::string_view name;
    AttributeKind kind = AttributeKind::integer;
    std::string_view unit;
    bool uses_timing = false;
    std::int32_t (*integer)(const gcode::Run&) = nullptr;
    std::vector<float> (*numbers)(const gcode::Toolpath&) = nullptr;  // null: given to BeadAttributes
};

constexpr auto kInteger = AttributeKind::integer;
constexpr auto kNumber = AttributeKind::number;
constexpr std::array<Facts, kAttributeCount> kFacts{{
    {"layer", kInteger, "", false, layerOf, nullptr},
    {"time", kNumber, "s", true, nullptr, starts},
    {"feature", kInteger, "", false, featureOf, nullptr},
    {"tool", kInteger, "", false, toolOf, nullptr},
    {"object", kInteger, "", false, objectOf, nullptr},
    {"width", kNumber, "mm", false, nullptr, widths},
    {"height", kNumber, "mm", false, nullptr, heights},
    {"speed", kNumber, "mm/s", true, nullptr, speeds},
    {"flow", kNumber, "mm^3/s", true, nullptr, flows},
    {"overfill", kNumber, "", false, nullptr, nullptr},
    {"layer_time", kNumber, "s", true, nullptr, layerTimes},
    {"temperature", kNumber, "C", false, nullptr, temperatures},  // the font of legends is ASCII
    {"fan", kNumber, "%", false, nullptr, fans},
    {"acceleration", kNumber, "mm/s^2", false, nullptr, accelerations},
    {"pressure_advance", kNumber, "s", false, nullptr, pressureAdvances},
    {"color", AttributeKind::color, "", false, nullptr, nullptr},
}};

const Facts& factsOf(Attribute attribute) { return kFacts[static_cast<std::size_t>(attribute)]; }

template <typename Grid>
openvdb::GridBase::Ptr emptyGrid(const openvdb::FloatGrid& surface) {
    using Value = typename Grid::ValueType;
    return Grid::create(
        typename Grid::TreePtrType(new typename Grid::TreeType(surface.tree(), Value(0), openvdb::TopologyCopy())));
}

template <typename Grid, typename ValueOf>
void fill(openvdb::GridBase& base, const openvdb::Coord& origin, std::span<const std::uint32_t> beads,
          const ValueOf& value_of) {
    auto* leaf = static_cast<Grid&>(base).tree().probeLeaf(origin);
    if (leaf == nullptr) return;
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
        const std::uint32_t bead = beads[voxel.pos()];
        if (bead != std::numeric_limits<std::uint32_t>::max()) voxel.setValue(value_of(bead));
    }
}

}  // namespace

AttributeKind attributeKind(Attribute attribute) { return factsOf(attribute).kind; }
std::string_view attributeName(Attribute attribute) { return factsOf(attribute).name; }
bool usesTiming(Attribute attribute) { return factsOf(attribute).uses_timing; }

double bytesPerLeaf(std::span<const Attribute> attributes) {
    double bytes = kBytesPerLeaf;
    for (const Attribute attribute : attributes) {
        const std::size_t value =
            attributeKind(attribute) == AttributeKind::color ? sizeof(openvdb::Vec3f) : sizeof(float);
        bytes += kBytesPerLeaf + static_cast<double>(openvdb::FloatTree::LeafNodeType::SIZE * (value - sizeof(float)));
    }
    return bytes;
}

std::vector<std::string_view> attributeNames() {
    std::vector<std::string_view> names;
    names.reserve(kFacts.size());
    for (const Facts& facts : kFacts) names.push_back(facts.name);
    return names;
}

std::string_view attributeUnit(std::string_view name) {
    if (name == "deviation") return "mm";
    const auto known =
        std::find_if(kFacts.begin(), kFacts.end(), [name](const Facts& facts) { return facts.name == name; });
    return known == kFacts.end() ? std::string_view() : known->unit;
}

std::vector<Attribute> parseGrids(std::string_view text) {
    const std::vector<std::string_view> names = attributeNames();
    std::vector<Attribute> attributes;
    for (const std::string_view name : splitList(text)) {
        if (name == "surface") continue;
        const auto known = std::find(names.begin(), names.end(), name);
        if (known == names.end())
            throw UsageError(fmt::format("--grids {}: expected names separated by commas, of surface, {}{}", name,
                                         fmt::join(names, ", "), didYouMean(name, names)));
        const auto attribute = static_cast<Attribute>(known - names.begin());
        if (std::find(attributes.begin(), attributes.end(), attribute) == attributes.end())
            attributes.push_back(attribute);
    }
    return attributes;
}

BeadAttributes::BeadAttributes(const gcode::Toolpath& toolpath, std::span<const Attribute> attributes,
                               std::vector<float> overfill)
    : toolpath_(toolpath) {
    numbers_[static_cast<std::size_t>(Attribute::overfill)] = std::move(overfill);
    for (const Attribute attribute : attributes) {
        if (const Facts& facts = factsOf(attribute); facts.numbers != nullptr)
            numbers_[static_cast<std::size_t>(attribute)] = facts.numbers(toolpath);
        if (attribute == Attribute::color && !toolpath.color_changes.empty()) color_ = colorsOfBeads(toolpath);
    }
}

std::int32_t BeadAttributes::integer(Attribute attribute, std::uint32_t bead) const {
    return factsOf(attribute).integer(toolpath_.runOf(toolpath_.beads[bead]));
}

std::size_t BeadAttributes::bytes() const {
    std::size_t bytes = color_.size() * sizeof(color_[0]);
    for (const std::vector<float>& numbers : numbers_) bytes += numbers.size() * sizeof(float);
    return bytes;
}

openvdb::Vec3f BeadAttributes::color(std::uint32_t bead) const {
    return color_.empty() ? linearOf(gcode::colorOf(toolpath_, bead)) : color_[bead];
}

std::vector<openvdb::GridBase::Ptr> makeAttributeGrids(const gcode::Toolpath& toolpath,
                                                       std::span<const Attribute> attributes,
                                                       const openvdb::FloatGrid& surface) {
    std::vector<openvdb::GridBase::Ptr> grids;
    for (const Attribute attribute : attributes) {
        openvdb::GridBase::Ptr grid;
        switch (attributeKind(attribute)) {
            case AttributeKind::integer:
                grid = emptyGrid<openvdb::Int32Grid>(surface);
                break;
            case AttributeKind::number:
                grid = emptyGrid<openvdb::FloatGrid>(surface);
                break;
            case AttributeKind::color:
                grid = emptyGrid<openvdb::Vec3SGrid>(surface);
                break;
        }
        grid->setName(std::string(attributeName(attribute)));
        grid->setTransform(surface.transform().copy());
        std::string names;
        if (attribute == Attribute::feature)
            for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
                names +=
                    fmt::format("{}{} {}", f > 0 ? ", " : "", f, gcode::featureName(static_cast<gcode::Feature>(f)));
        if (attribute == Attribute::object)
            for (std::size_t n = 1; n < toolpath.objects.size(); ++n)
                names += fmt::format("{}{} {}", n > 1 ? ", " : "", n, toolpath.objects[n]);
        if (!names.empty()) grid->insertMeta("names", openvdb::StringMetadata(names));
        grids.push_back(std::move(grid));
    }
    return grids;
}

void fillLeaf(openvdb::GridBase& grid, Attribute attribute, const openvdb::Coord& origin, const BeadAttributes& values,
              std::span<const std::uint32_t> beads_of_voxels) {
    switch (attributeKind(attribute)) {
        case AttributeKind::integer:
            return fill<openvdb::Int32Grid>(grid, origin, beads_of_voxels,
                                            [&](std::uint32_t bead) { return values.integer(attribute, bead); });
        case AttributeKind::number:
            return fill<openvdb::FloatGrid>(grid, origin, beads_of_voxels,
                                            [&](std::uint32_t bead) { return values.number(attribute, bead); });
        case AttributeKind::color:
            return fill<openvdb::Vec3SGrid>(grid, origin, beads_of_voxels,
                                            [&](std::uint32_t bead) { return values.color(bead); });
    }
}

}  // namespace stratum::voxelize
