#include "voxelize/grid/attributes.h"

#include "base/error.h"
#include "base/nearest_name.h"
#include "base/srgb.h"
#include "base/text.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/summary.h"
#include "voxelize/beads/bead_field.h"

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

constexpr std::array<std::string_view, 13> kNames{"layer",       "time",  "feature", "tool",     "object",
                                                  "width",       "speed", "flow",    "overfill", "layer_time",
                                                  "temperature", "fan",   "color"};
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

// By bead: the value of its tool, or of all tools, that was set last. A tool that is used before its own was set has
// the first one that is set.
std::vector<float> valuesOfBeads(const gcode::Toolpath& toolpath, const std::vector<gcode::SetValue>& set, bool by_tool,
                                 std::string_view what) {
    if (set.empty())
        throw InputError(
            fmt::format("the program never sets {}; print start macros may do so where no file tells it; "
                        "choose another attribute",
                        what));
    std::array<float, 256> of_tool{};
    of_tool.fill(by_tool ? set.front().value : 0);
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

// mm^2, of the bead's section.
float areaOf(const gcode::Toolpath& toolpath, std::uint32_t index) {
    const gcode::Bead& bead = toolpath.beads[index];
    return static_cast<float>(
        gcode::sectionArea(static_cast<double>(bead.width), static_cast<double>(toolpath.runOf(bead).height)));
}

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

AttributeKind attributeKind(Attribute attribute) {
    switch (attribute) {
        case Attribute::time:
        case Attribute::width:
        case Attribute::speed:
        case Attribute::flow:
        case Attribute::overfill:
        case Attribute::layer_time:
        case Attribute::temperature:
        case Attribute::fan:
            return AttributeKind::number;
        case Attribute::color:
            return AttributeKind::color;
        default:
            return AttributeKind::integer;
    }
}

std::string_view attributeName(Attribute attribute) { return kNames[static_cast<std::size_t>(attribute)]; }

std::vector<Attribute> parseGrids(std::string_view text) {
    std::vector<Attribute> attributes;
    for (const std::string_view name : splitList(text)) {
        if (name == "surface") continue;
        const auto known = std::find(kNames.begin(), kNames.end(), name);
        if (known == kNames.end())
            throw UsageError(fmt::format("--grids {}: expected names separated by commas, of surface, {}{}", name,
                                         fmt::join(kNames, ", "), didYouMean(name, kNames)));
        const auto attribute = static_cast<Attribute>(known - kNames.begin());
        if (std::find(attributes.begin(), attributes.end(), attribute) == attributes.end())
            attributes.push_back(attribute);
    }
    return attributes;
}

bool usesTiming(Attribute attribute) {
    return attribute == Attribute::time || attribute == Attribute::speed || attribute == Attribute::flow ||
           attribute == Attribute::layer_time;
}

BeadAttributes::BeadAttributes(const gcode::Toolpath& toolpath, std::span<const Attribute> attributes,
                               std::vector<float> overfill)
    : toolpath_(toolpath), overfill_(std::move(overfill)) {
    const auto wanted = [attributes](Attribute attribute) {
        return std::find(attributes.begin(), attributes.end(), attribute) != attributes.end();
    };
    if (wanted(Attribute::width)) {
        width_.reserve(toolpath.beads.size());
        for (const gcode::Bead& bead : toolpath.beads)
            width_.push_back(static_cast<float>(2 * sectionOf(toolpath, bead).halfWidth()));
    }
    if (wanted(Attribute::color) && !toolpath.color_changes.empty()) color_ = colorsOfBeads(toolpath);
    if (wanted(Attribute::layer_time))
        for (const double seconds : gcode::layerSeconds(toolpath)) layer_time_.push_back(static_cast<float>(seconds));
    if (wanted(Attribute::temperature))
        temperature_ = valuesOfBeads(toolpath, toolpath.temperatures, true, "a temperature of a nozzle");
    if (wanted(Attribute::fan)) fan_ = valuesOfBeads(toolpath, toolpath.fans, false, "a fan");
    if (!wanted(Attribute::time)) return;
    start_.reserve(toolpath.beads.size());
    for (const gcode::BeadTiming& timing : toolpath.timing) start_.push_back(static_cast<float>(timing.start));
    if (!start_.empty()) return;
    double time = 0;
    for (const gcode::Bead& bead : toolpath.beads) {
        start_.push_back(static_cast<float>(time));
        time += gcode::beadSeconds(toolpath, bead);
    }
}

std::int32_t BeadAttributes::integer(Attribute attribute, std::uint32_t bead) const {
    const gcode::Run& run = toolpath_.runOf(toolpath_.beads[bead]);
    switch (attribute) {
        case Attribute::layer:
            return static_cast<std::int32_t>(run.layer);
        case Attribute::feature:
            return static_cast<std::int32_t>(run.feature);
        case Attribute::object:
            return run.object;
        default:
            return run.tool;
    }
}

float BeadAttributes::number(Attribute attribute, std::uint32_t bead) const {
    if (attribute == Attribute::time) return start_[bead];
    if (attribute == Attribute::width) return width_[bead];
    if (attribute == Attribute::overfill) return overfill_[bead];
    if (attribute == Attribute::layer_time) return layer_time_[toolpath_.runOf(toolpath_.beads[bead]).layer];
    if (attribute == Attribute::temperature) return temperature_[bead];
    if (attribute == Attribute::fan) return fan_[bead];
    if (attribute == Attribute::flow && !toolpath_.flow.empty()) return toolpath_.flow[bead].rate;
    const float per_mm = attribute == Attribute::flow ? areaOf(toolpath_, bead) : 1;
    const float seconds = toolpath_.timing.empty() ? 0 : toolpath_.timing[bead].seconds;
    if (!(seconds > 0)) return per_mm * toolpath_.runOf(toolpath_.beads[bead]).speed;
    return per_mm * static_cast<float>(gcode::beadLength(toolpath_, toolpath_.beads[bead])) / seconds;
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
