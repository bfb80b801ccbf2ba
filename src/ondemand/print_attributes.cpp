#include "ondemand/print_attributes.h"

#include "base/error.h"
#include "ondemand/bead_lookup.h"
#include "voxelize/grid/deposit_balance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace stratum::ondemand {
glm::vec3 valueOf(const voxelize::BeadAttributes& values, voxelize::Attribute attribute, std::uint32_t bead) {
    switch (voxelize::attributeKind(attribute)) {
        case voxelize::AttributeKind::integer:
            return {static_cast<float>(values.integer(attribute, bead)), 0.0F, 0.0F};
        case voxelize::AttributeKind::number:
            return {values.number(attribute, bead), 0.0F, 0.0F};
        default: {
            const openvdb::Vec3f color = values.color(bead);
            return {color[0], color[1], color[2]};
        }
    }
}

namespace {

using voxelize::Attribute;

class Lookup final : public march::AttributeLookup {
public:
    Lookup(const PrintField& field, const voxelize::BeadAttributes& values, Attribute attribute)
        : beads_(field), values_(values), attribute_(attribute) {}

    // As march::AttributeLookup of a grid, and inside.
    std::optional<glm::vec3> at(const glm::dvec3& position) override {
        const std::optional<std::uint32_t> bead = beads_.at(position);
        if (!bead) return std::nullopt;
        return valueOf(values_, attribute_, *bead);
    }

private:
    BeadLookup beads_;
    const voxelize::BeadAttributes& values_;
    const Attribute attribute_;
};

class GrainLookup final : public march::AttributeLookup {
public:
    explicit GrainLookup(const PrintField& field) : field_(field), beads_(field) {}

    std::optional<glm::vec3> at(const glm::dvec3& position) override {
        const std::optional<std::uint32_t> index = beads_.at(position);
        if (!index) return std::nullopt;
        const PrintLayout& layout = field_.layout();
        const gcode::Bead& bead = layout.toolpath->beads[*index];
        const openvdb::math::Transform& transform = field_.transform();
        const openvdb::Vec3d place =
            layout.lattice.voxel_size * transform.worldToIndex(openvdb::Vec3d(position.x, position.y, position.z));
        const auto direction = gcode::pathDirection(*layout.toolpath, bead, place.x(), place.y());
        // The map scales all axes alike; its shift is no part of a direction.
        const openvdb::Vec3d world =
            transform.baseMap()->applyJacobian(openvdb::Vec3d(direction.x, direction.y, direction.z));
        const double length = world.length();
        if (!(length > 0)) return std::nullopt;
        return glm::vec3(glm::dvec3(world.x(), world.y(), world.z()) / length);
    }

private:
    const PrintField& field_;
    BeadLookup beads_;
};

class PrintGrain final : public march::AttributeSource {
public:
    explicit PrintGrain(std::shared_ptr<const PrintField> field) : field_(std::move(field)) {}

    std::unique_ptr<march::AttributeLookup> makeLookup() const override {
        return std::make_unique<GrainLookup>(*field_);
    }
    std::size_t bytes() const override { return 0; }

private:
    const std::shared_ptr<const PrintField> field_;
};

// What BeadAttributes wants, if that is the attribute.
std::vector<float> overfillFor(const PrintField& field, Attribute attribute) {
    if (attribute != Attribute::overfill) return {};
    const auto& layout = field.layout();
    return voxelize::overfillOfBeads(*layout.toolpath, layout.stack);
}

class PrintAttribute final : public march::AttributeSource {
public:
    PrintAttribute(std::shared_ptr<const PrintField> field, Attribute attribute)
        : field_(std::move(field)),
          attribute_(attribute),
          values_(*field_->layout().toolpath, std::span(&attribute_, 1), overfillFor(*field_, attribute_)) {}

    std::unique_ptr<march::AttributeLookup> makeLookup() const override {
        return std::make_unique<Lookup>(*field_, values_, attribute_);
    }
    std::size_t bytes() const override { return values_.bytes(); }

private:
    const std::shared_ptr<const PrintField> field_;
    const Attribute attribute_;
    const voxelize::BeadAttributes values_;
};

}  // namespace

voxelize::Attribute attributeNamed(std::string_view name) {
    try {
        const std::vector<Attribute> attributes = voxelize::parseGrids(name);
        if (attributes.size() == 1) return attributes.front();
    } catch (const UsageError&) {
        // said below, for what was asked here
    }
    throw UsageError(fmt::format("{}: prints have no such attribute; choose one of {}", name,
                                 fmt::join(voxelize::attributeNames(), ", ")));
}

std::shared_ptr<const march::AttributeSource> makePrintAttribute(std::shared_ptr<const PrintField> field,
                                                                 voxelize::Attribute attribute) {
    return std::make_shared<const PrintAttribute>(std::move(field), attribute);
}

std::shared_ptr<const march::AttributeSource> makePrintGrain(std::shared_ptr<const PrintField> field) {
    return std::make_shared<const PrintGrain>(std::move(field));
}

trace::AttributeSummary summarize(const PrintField& field, voxelize::Attribute attribute,
                                  std::span<const std::uint32_t> selection) {
    // The empty grid of that attribute has its type and the names.
    const gcode::Toolpath& toolpath = *field.layout().toolpath;
    const auto nothing = openvdb::FloatGrid::create();
    const std::array<Attribute, 1> wanted{attribute};
    const auto grids = voxelize::makeAttributeGrids(toolpath, wanted, *nothing);
    trace::AttributeSummary summary = march::summarize(*grids.front());
    const voxelize::BeadAttributes values(toolpath, wanted, overfillFor(field, attribute));
    std::set<glm::vec3, trace::Before> colors;
    glm::vec3 last(-1.0F);
    bool any = false;
    std::set<int> integers;
    for (const std::uint32_t bead : selection) {
        const glm::vec3 value = valueOf(values, attribute, bead);
        if (value == last) continue;
        if (!(std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z))) {
            ++summary.not_finite;
            continue;
        }
        last = value;
        if (summary.kind == trace::AttributeSummary::Kind::color) {
            colors.insert(value);
            continue;
        }
        const auto number = static_cast<double>(value.x);
        summary.least = any ? std::min(summary.least, number) : number;
        summary.most = any ? std::max(summary.most, number) : number;
        any = true;
        if (summary.kind == trace::AttributeSummary::Kind::integer &&
            integers.size() <= trace::AttributeSummary::kMostValues)
            integers.insert(static_cast<int>(number));
    }
    if (integers.size() <= trace::AttributeSummary::kMostValues)
        summary.values.assign(integers.begin(), integers.end());
    if (colors.size() > trace::AttributeSummary::kMostColors)
        throw InputError(fmt::format("{} has more than {} colours; a print has a few", field.name(),
                                     trace::AttributeSummary::kMostColors));
    summary.colors.assign(colors.begin(), colors.end());
    return summary;
}

}  // namespace stratum::ondemand
