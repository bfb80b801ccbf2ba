#include "march/attribute/attribute_grid.h"

#include "base/error.h"
#include "base/input_file.h"
#include "march/file/vdb_walker.h"
#include "march/file/whole_grid.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <type_traits>
#include <utility>

namespace stratum::march {
namespace {

glm::vec3 toGlm(const openvdb::Vec3f& v) { return {v[0], v[1], v[2]}; }
glm::vec3 toGlm(float v) { return {v, 0.0F, 0.0F}; }
// Exact up to 2^24: layers, tools and features are fewer.
glm::vec3 toGlm(std::int32_t v) { return {static_cast<float>(v), 0.0F, 0.0F}; }

/// Calls f with the grid of its actual type; false if it is none of the three.
template <typename F>
bool visit(const openvdb::GridBase& grid, const F& f) {
    if (grid.isType<openvdb::Int32Grid>())
        f(static_cast<const openvdb::Int32Grid&>(grid));
    else if (grid.isType<openvdb::FloatGrid>())
        f(static_cast<const openvdb::FloatGrid&>(grid));
    else if (grid.isType<openvdb::Vec3SGrid>())
        f(static_cast<const openvdb::Vec3SGrid&>(grid));
    else
        return false;
    return true;
}

template <typename Grid>
class Lookup final : public AttributeLookup {
public:
    explicit Lookup(const Grid& grid) : map_(grid.transform().baseMap()), accessor_(grid.getConstAccessor()) {}

    std::optional<glm::vec3> at(const glm::dvec3& position) override {
        const openvdb::Vec3d p = map_->applyInverseMap(openvdb::Vec3d(position.x, position.y, position.z));
        const openvdb::Coord cell = openvdb::Coord::floor(p);
        double nearest = 4.0;  // more than any corner's
        typename Grid::ValueType value{};
        for (int c = 0; c < 8; ++c) {
            const openvdb::Coord voxel = cell.offsetBy(c >> 2, c >> 1 & 1, c & 1);
            const double square = (p - voxel.asVec3d()).lengthSqr();
            typename Grid::ValueType here{};
            if (square >= nearest || !accessor_.probeValue(voxel, here)) continue;
            nearest = square;
            value = here;
        }
        if (nearest >= 4.0) return std::nullopt;
        return toGlm(value);
    }

private:
    openvdb::math::MapBase::ConstPtr map_;
    typename Grid::ConstAccessor accessor_;
};

/// "0 none, 1 skirt, ..." as gcode2vdb writes it.
std::vector<std::string> labelsOf(const openvdb::GridBase& grid) {
    std::vector<std::string> labels;
    const auto names = grid.getMetadata<openvdb::StringMetadata>("names");
    if (!names) return labels;
    std::string_view rest = names->value();
    while (!rest.empty()) {
        const std::size_t comma = rest.find(", ");
        const std::string_view entry = rest.substr(0, comma);
        rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 2);
        std::size_t id = 0;
        const auto [end, error] = std::from_chars(entry.data(), entry.data() + entry.size(), id);
        constexpr std::size_t kMost = 4096;
        if (error != std::errc() || id >= kMost || end == entry.data() + entry.size() || *end != ' ') continue;
        if (labels.size() <= id) labels.resize(id + 1);
        labels[id] = std::string(end + 1, entry.data() + entry.size());
    }
    return labels;
}

std::string notAnAttribute(const std::string& where, const std::string& name, const std::string& holds) {
    return fmt::format("{}: the grid {} holds {}; attributes are Int32, float or Vec3f", where, name, holds);
}

}  // namespace

openvdb::GridBase::ConstPtr readAttributeGrid(const std::filesystem::path& path, const std::string& name,
                                              const openvdb::FloatGrid& surface) {
    openvdb::GridBase::Ptr grid;
    std::string seen;
    const std::string where = path.string();
    const InputFile input(path);
    VdbCursor cursor(input, where);
    const VdbHeads heads = walkVdbHeads(cursor);
    try {
        for (const VdbGrid& in_file : heads.grids) {
            seen += (seen.empty() ? "" : ", ") + nameOf(in_file);
            if (nameOf(in_file) != name) continue;
            grid = headOf(heads, in_file);
            if (!grid) throw InputError(notAnAttribute(where, name, in_file.type));
            if (visit(*grid, [](const auto&) {})) grid = readWholeGrid(heads, in_file, *grid, input, where);
        }
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: is not a readable .vdb file ({}); is it cut short?", path.string(), error.what()));
    }
    if (!grid)
        throw InputError(fmt::format("{}: has no grid named {}; make one with gcode2vdb --grids {}. It has: {}",
                                     path.string(), name, name, seen));
    if (!visit(*grid, [](const auto&) {})) throw InputError(notAnAttribute(where, name, grid->valueType()));
    if (grid->transform() != surface.transform())
        throw InputError(
            fmt::format("{}: the grid {} lies on another lattice than the surface {}; write both in one run",
                        path.string(), name, surface.getName()));
    return grid;
}

namespace {

// Metadata "range" of a grid of numbers: what to show, if a few extremes would hide the rest.
void showRange(const openvdb::GridBase& grid, trace::AttributeSummary& summary) {
    const auto range = grid.getMetadata<openvdb::Vec2DMetadata>("range");
    if (!range || summary.kind != trace::AttributeSummary::Kind::number) return;
    const openvdb::Vec2d shown = range->value();
    if (!std::isfinite(shown[0]) || !std::isfinite(shown[1]) || !(shown[0] < shown[1])) return;
    summary.least = shown[0];
    summary.most = shown[1];
}

}  // namespace

trace::AttributeSummary summarize(const openvdb::GridBase& grid) {
    trace::AttributeSummary summary;
    summary.labels = labelsOf(grid);
    visit(grid, [&](const auto& typed) {
        using Value = typename std::decay_t<decltype(typed)>::ValueType;
        if constexpr (std::is_same_v<Value, openvdb::Vec3f>) {
            summary.kind = trace::AttributeSummary::Kind::color;
            std::set<glm::vec3, trace::Before> colors;
            openvdb::Vec3f last(-1.0F);
            for (auto it = typed.cbeginValueOn(); it; ++it) {
                if (*it == last) continue;
                if (!it->isFinite()) {
                    ++summary.not_finite;
                    continue;
                }
                last = *it;
                colors.insert(toGlm(last));
                if (colors.size() > trace::AttributeSummary::kMostColors)
                    throw InputError(fmt::format("the grid {} has more than {} colours; a print has a few",
                                                 grid.getName(), trace::AttributeSummary::kMostColors));
            }
            summary.colors.assign(colors.begin(), colors.end());
        } else {
            summary.kind = std::is_same_v<Value, std::int32_t> ? trace::AttributeSummary::Kind::integer
                                                               : trace::AttributeSummary::Kind::number;
            bool any = false;
            std::set<int> values;
            for (auto it = typed.cbeginValueOn(); it; ++it) {
                const auto v = static_cast<double>(*it);
                if (!std::isfinite(v)) {
                    ++summary.not_finite;
                    continue;
                }
                summary.least = any ? std::min(summary.least, v) : v;
                summary.most = any ? std::max(summary.most, v) : v;
                any = true;
                if constexpr (std::is_same_v<Value, std::int32_t>)
                    if (values.size() <= trace::AttributeSummary::kMostValues) values.insert(*it);
            }
            if (values.size() <= trace::AttributeSummary::kMostValues)
                summary.values.assign(values.begin(), values.end());
            showRange(grid, summary);
        }
    });
    return summary;
}

std::unique_ptr<AttributeLookup> makeAttributeLookup(const openvdb::GridBase& grid) {
    std::unique_ptr<AttributeLookup> lookup;
    visit(grid, [&](const auto& typed) { lookup = std::make_unique<Lookup<std::decay_t<decltype(typed)>>>(typed); });
    return lookup;
}

namespace {

class GridAttribute final : public AttributeSource {
public:
    explicit GridAttribute(openvdb::GridBase::ConstPtr grid) : grid_(std::move(grid)) {}
    std::unique_ptr<AttributeLookup> makeLookup() const override { return makeAttributeLookup(*grid_); }
    std::size_t bytes() const override { return grid_->memUsage(); }

private:
    openvdb::GridBase::ConstPtr grid_;
};

}  // namespace

std::shared_ptr<const AttributeSource> makeAttributeSource(openvdb::GridBase::ConstPtr grid) {
    if (!grid) return nullptr;
    return std::make_shared<const GridAttribute>(std::move(grid));
}

}  // namespace stratum::march
