#include "report/print_report.h"

#include "gcode/toolpath/purpose.h"
#include "report/level_set/field_probe.h"
#include "report/level_set/outside.h"
#include "report/level_set/solid_sums.h"
#include "report/plan/plan_contact.h"
#include "report/plan/slabs.h"
#include "report/walls/roughness.h"
#include "report/walls/thinnest_wall.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/beads/placement.h"
#include "voxelize/grid/deposit_balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>

namespace stratum::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kKeep = "build it with --interior keep";

const Definition& definitionOf(std::span<const Definition> definitions, std::string_view key) {
    const auto found = std::find_if(definitions.begin(), definitions.end(),
                                    [key](const Definition& definition) { return definition.key == key; });
    assert(found != definitions.end());
    return *found;
}

// The tensor in axes of the world.
Matrix3 turned(const Matrix3& tensor, const voxelize::Placement& placement) {
    if (placement.tilt == 0) return tensor;
    Matrix3 rows;  // T R^T, whose rows are R T's, since T is symmetric
    for (std::size_t a = 0; a < 3; ++a) rows[a] = worldOf(tensor[a], placement);
    Matrix3 result;
    for (std::size_t b = 0; b < 3; ++b) result[b] = worldOf({rows[0][b], rows[1][b], rows[2][b]}, placement);
    return result;
}

double percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

/// One print: each method adds the numbers of one kind.
class Report {
public:
    Report(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
           const voxelize::Lattice& lattice, const std::optional<motion::PrintTimes>& times,
           const ReportOptions& options)
        : grid_(grid), toolpath_(toolpath), selection_(selection), lattice_(lattice), times_(times), o_(options) {}

    PrintReport make() {
        report_.source = o_.source;
        report_.selection = o_.selection;
        report_.slicer = toolpath_.slicer;
        report_.bead_model = gcode::describe(toolpath_.deposit);
        report_.voxel_mm = lattice_.voxel_size;
        report_.layer_height_mm = lattice_.layer_height;
        report_.culled = o_.culled;
        addMaterial();
        const voxelize::LayerStack stack = voxelize::stackLayers(toolpath_, selection_);
        addLevelSet(stack);
        addContact();
        addDepositedByLayer();
        sortByDefinition();
        return std::move(report_);
    }

private:
    template <typename Value>
    Number& add(std::string_view key, const Value& value) {
        return report_.numbers.emplace_back(Number{&definitionOf(numberDefinitions(), key), value, {}});
    }
    void leaveOut(std::string_view key, std::string why, std::string remedy) {
        report_.left_out.push_back({&definitionOf(numberDefinitions(), key), std::move(why), std::move(remedy)});
    }

    // By tool, and in all.
    void addMaterial() {
        std::vector<double> all;
        std::vector<double> selected;
        const auto addTo = [&](std::vector<double>& volumes, std::uint32_t bead) {
            const std::size_t tool = toolpath_.runOf(toolpath_.beads[bead]).tool;
            if (volumes.size() <= tool) volumes.resize(tool + 1);
            volumes[tool] += gcode::laidVolume(toolpath_, bead);
        };
        for (std::uint32_t bead = 0; bead < toolpath_.beads.size(); ++bead) addTo(all, bead);
        for (const std::uint32_t bead : selection_) addTo(selected, bead);
        const gcode::StatedFacts& stated = toolpath_.stated;
        const auto ofTool = [](const std::optional<double>& given, const std::vector<double>& list, std::size_t tool) {
            if (given) return given;
            return tool < list.size() && list[tool] > 0 ? std::optional(list[tool]) : std::nullopt;
        };
        double length = 0;
        for (std::size_t tool = 0; tool < selected.size(); ++tool) {
            if (!(selected[tool] > 0)) continue;
            ToolUse use;
            use.tool = tool;
            if (tool < stated.materials.size()) use.material = stated.materials[tool];
            use.volume_mm3 = selected[tool];
            if (tool < toolpath_.filament_by_tool.size())
                use.filament_mm = toolpath_.filament_by_tool[tool] * selected[tool] / all[tool];
            use.density = ofTool(o_.density, stated.densities, tool);
            use.price = ofTool(o_.price, stated.prices, tool);
            deposited_ += use.volume_mm3;
            length += use.filament_mm;
            report_.tools.push_back(std::move(use));
        }
        add("deposited_volume", deposited_);
        if (length > 0)
            add("filament_length", length);
        else
            leaveOut("filament_length", "the beads come from no filament", "read them from G-code");
        addMass();
        if (times_)
            add("time", times_->total);
        else
            leaveOut("time", "the motion was not planned", "read the print with its times");
    }

    void addMass() {
        double mass = 0;
        double cost = 0;
        std::string no_density;
        std::string no_price;
        for (const ToolUse& use : report_.tools) {
            const auto note = [&](std::string& list) {
                list += fmt::format("{}{}", list.empty() ? "" : ", ", use.tool);
            };
            if (!use.density) note(no_density);
            if (!use.price) note(no_price);
            const double grams = 1e-3 * use.volume_mm3 * use.density.value_or(0);
            mass += grams;
            cost += 1e-3 * grams * use.price.value_or(0);
        }
        const std::string give_density = "give it with --density G_CM3";
        if (no_density.empty()) {
            add("mass", mass);
            mass_ = mass;
        } else {
            leaveOut("mass", fmt::format("the file states no density for tool {}", no_density), give_density);
        }
        if (no_density.empty() && no_price.empty())
            add("cost", cost);
        else if (no_price.empty())
            leaveOut("cost", fmt::format("the file states no density for tool {}", no_density), give_density);
        else
            leaveOut("cost", fmt::format("the file states no price for tool {}", no_price),
                     "give it with --price PER_KG");
    }

    // What is measured of the level set.
    void addLevelSet(const voxelize::LayerStack& stack) {
        const double unit = grid_.voxelSize()[0] / lattice_.voxel_size;
        const LeafMap map(grid_);
        std::unique_ptr<const Outside> outside;
        if (!o_.culled)
            outside = std::make_unique<Outside>(map, hullClearance(lattice_) * unit, grid_.voxelSize()[0],
                                                static_cast<double>(grid_.background()));
        const SolidSums sums = sumSolid(map, grid_.background(), grid_.voxelSize()[0], outside.get());
        addVolume(sums, stack);
        if (!o_.culled) addBalance(sums);
        addSlabs(stack, sums);
        addWalls(stack, map, outside.get());
    }

    void addVolume(const SolidSums& sums, const voxelize::LayerStack& stack) {
        const double area = lattice_.voxel_size * lattice_.voxel_size;
        const double cell = area * lattice_.voxel_size;
        Number& outer = add("outer_surface", sums.outer_area * area);
        outer.details.emplace_back("measured_leaves", static_cast<double>(sums.area_leaves));
        if (o_.culled) {
            add("enclosed_volume", sums.volume * cell);
            for (const char* key : {"plastic_volume", "porosity", "open_porosity", "closed_porosity", "center_of_mass",
                                    "inertia", "inertia_of_volume", "inner_surface", "thinnest_wall"})
                leaveOut(key, "what the outside can't reach was filled (--interior cull)", kKeep);
            return;
        }
        double open = 0;
        double closed = 0;
        for (const RowSums& row : sums.rows) {
            open += row.open;
            closed += row.closed;
        }
        // Values between samples close narrow gaps, so that the level set holds a little more than the beads; of walls
        // thinner than a few voxels it holds less.
        const double plastic = voxelize::solidVolume(toolpath_, stack, std::numeric_limits<std::uint32_t>::max());
        const double enclosed = std::max((sums.volume + open + closed) * cell, plastic);
        const double pores = enclosed - plastic;
        const double airtight = std::min(closed * cell, pores);
        add("plastic_volume", plastic);
        plastic_ = plastic;
        add("enclosed_volume", enclosed);
        add("porosity", percent(pores, enclosed));
        add("open_porosity", percent(pores - airtight, enclosed));
        add("closed_porosity", percent(airtight, enclosed));
        Number& inner = add("inner_surface", sums.inner_area * area);
        inner.details.emplace_back("measured_leaves", static_cast<double>(sums.area_leaves));
    }

    void addBalance(const SolidSums& sums) {
        if (!(sums.volume > 0)) {
            for (const char* key : {"center_of_mass", "inertia", "inertia_of_volume"})
                leaveOut(key, "the level set holds no plastic", "choose a smaller --voxel-size");
            return;
        }
        const double h = lattice_.voxel_size;
        const double v = sums.volume;
        const Vector3 middle{sums.first[0] / v, sums.first[1] / v, sums.first[2] / v};
        const voxelize::Placement lies = voxelize::placementOf(toolpath_);
        add("center_of_mass", worldOf({middle[0] * h, middle[1] * h, middle[2] * h + lattice_.origin_z}, lies));
        // Central second moments, then the tensor.
        constexpr int kIndex[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
        const auto central = [&](std::size_t a, std::size_t b) {
            return (sums.second[kIndex[a][b]] - v * middle[a] * middle[b]) * std::pow(h, 5);
        };
        const double trace = central(0, 0) + central(1, 1) + central(2, 2);
        Matrix3 tensor{};
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) tensor[a][b] = (a == b ? trace : 0) - central(a, b);
        tensor = turned(tensor, lies);
        // The cells hold some per cent more than the beads, all over the print.
        const double volume = plastic_ > 0 ? plastic_ : v * std::pow(h, 3);
        for (Vector3& row : tensor)
            for (double& value : row) value *= volume / (v * std::pow(h, 3));
        add("inertia_of_volume", tensor);
        if (!mass_) {
            leaveOut("inertia", "the density is not known", "give it with --density G_CM3");
            return;
        }
        for (Vector3& row : tensor)
            for (double& value : row) value *= *mass_ / volume;
        add("inertia", tensor);
    }

    void addSlabs(const voxelize::LayerStack& stack, const SolidSums& sums) {
        if (o_.culled) return;
        const Slabs divided = divideByLayer(toolpath_, stack, lattice_, sums);
        report_.slabs_are_layers = divided.layers;
        Column plastic{&definitionOf(slabDefinitions(), "plastic_volume"), {}};
        Column porosity{&definitionOf(slabDefinitions(), "porosity"), {}};
        Column closed{&definitionOf(slabDefinitions(), "closed_porosity"), {}};
        for (const Slab& slab : divided.slabs) {
            report_.slabs.emplace_back(slab.bottom, slab.top);
            const double enclosed = slab.plastic + slab.open + slab.closed;
            plastic.values.push_back(slab.plastic);
            porosity.values.push_back(enclosed > 0 ? percent(slab.open + slab.closed, enclosed) : kNone);
            closed.values.push_back(enclosed > 0 ? percent(slab.closed, enclosed) : kNone);
        }
        report_.by_slab = {std::move(plastic), std::move(porosity), std::move(closed)};
    }

    // The selected beads of the part but those that iron what is there.
    std::vector<std::uint32_t> wallBeads() const {
        std::vector<std::uint32_t> beads =
            gcode::beadsUpTo(gcode::Purpose::part, gcode::purposesOf(toolpath_), selection_);
        std::erase_if(beads, [this](std::uint32_t bead) {
            return toolpath_.runOf(toolpath_.beads[bead]).feature == gcode::Feature::ironing;
        });
        return beads;
    }

    void addWalls(const voxelize::LayerStack& stack, const LeafMap& map, const Outside* outside) {
        const std::vector<std::uint32_t> beads = wallBeads();
        if (outside != nullptr) {
            if (const auto wall = findThinnestWall(grid_, toolpath_, beads, lattice_, map, *outside)) {
                const gcode::Bead& bead = toolpath_.beads[wall->bead];
                add("thinnest_wall", wall->thickness).details = {
                    {"at_mm", worldOf({wall->at.x, wall->at.y, wall->at.z}, voxelize::placementOf(toolpath_))},
                    {"line", static_cast<double>(toolpath_.lineOf(bead))},
                    {"measured", static_cast<double>(wall->walls)}};
            } else {
                leaveOut("thinnest_wall", "no bead of the part has the outside beside it", "select more of the print");
            }
        }
        const std::vector<RoughnessLine> lines =
            measureRoughness(grid_, toolpath_, stack, beads, lattice_, map, outside);
        if (lines.empty()) {
            for (const char* key : {"roughness_ra", "roughness_rz"})
                leaveOut(key, "no outer wall goes on for a sampling length", "select more layers of the print");
            return;
        }
        addRoughness("roughness_ra", lines, [](const RoughnessLine& line) { return line.ra; });
        addRoughness("roughness_rz", lines, [](const RoughnessLine& line) { return line.rz; });
    }

    template <typename Value>
    void addRoughness(const char* key, const std::vector<RoughnessLine>& lines, Value value) {
        double sum = 0;
        double least = std::numeric_limits<double>::max();
        double largest = 0;
        for (const RoughnessLine& line : lines) {
            sum += value(line);
            least = std::min(least, value(line));
            largest = std::max(largest, value(line));
        }
        add(key, 1e3 * sum / static_cast<double>(lines.size())).details = {
            {"least", 1e3 * least}, {"largest", 1e3 * largest}, {"lines", static_cast<double>(lines.size())}};
    }

    // What rests on what.
    void addContact() {
        const PlanContact contact = measureContact(toolpath_, selection_, lattice_);
        const auto base = std::find_if(contact.layers.begin(), contact.layers.end(),
                                       [](const LayerContact& layer) { return layer.area > 0; });
        if (base == contact.layers.end()) {
            for (const char* key : {"bed_contact", "bed_outline", "bonding_least", "bonding_mean", "unsupported",
                                    "overhang_45", "overhang_60", "overhang_75"})
                leaveOut(key, "all beads are sloped or round, and these numbers are of level, pressed ones",
                         "none for such a print");
            return;
        }
        if (toolpath_.belt_angle == 0) {
            add("bed_contact", contact.bed_contact);
            add("bed_outline", contact.bed_outline);
        } else {
            for (const char* key : {"bed_contact", "bed_outline"})
                leaveOut(key, "the print lies on a belt, and its layers lean over that", "none for such a print");
        }
        addLayerColumns(contact);
        LayerContact all;
        double least = std::numeric_limits<double>::max();
        std::size_t weakest = 0;
        for (auto layer = base + 1; layer != contact.layers.end(); ++layer) {
            if (layer->on_bed || !(layer->area > 0)) continue;
            all.area += layer->area;
            all.supported += layer->supported;
            for (std::size_t a = 0; a < kConeAngles.size(); ++a) all.beyond_cone[a] += layer->beyond_cone[a];
            if (layer->supported / layer->area < least) {
                least = layer->supported / layer->area;
                weakest = static_cast<std::size_t>(layer - contact.layers.begin());
            }
        }
        if (!(all.area > 0)) {
            for (const char* key : {"bonding_least", "bonding_mean"})
                leaveOut(key, "there is one layer alone", "select more layers of the print");
            return;
        }
        add("bonding_least", 100 * least).details = {{"layer", static_cast<double>(weakest)}};
        add("bonding_mean", percent(all.supported, all.area)).details = {{"share_of_level_beads", contact.level_share}};
        add("unsupported", all.area - all.supported);
        add("overhang_45", all.beyond_cone[0]);
        add("overhang_60", all.beyond_cone[1]);
        add("overhang_75", all.beyond_cone[2]);
    }

    void addLayerColumns(const PlanContact& contact) {
        bool base = true;
        for (const LayerContact& layer : contact.layers) {
            const bool rests = layer.area > 0 && !layer.on_bed && !base;
            if (layer.area > 0) base = false;
            columnOf("bonding").push_back(rests ? percent(layer.supported, layer.area) : kNone);
            columnOf("touching").push_back(rests ? percent(layer.contact, layer.area) : kNone);
            columnOf("unsupported").push_back(rests ? layer.area - layer.supported : kNone);
            columnOf("overhang_45").push_back(rests ? layer.beyond_cone[0] : kNone);
            columnOf("overhang_75").push_back(rests ? layer.beyond_cone[2] : kNone);
        }
    }

    std::vector<double>& columnOf(std::string_view key) {
        for (Column& column : report_.by_layer)
            if (column.definition->key == key) return column.values;
        return report_.by_layer.emplace_back(Column{&definitionOf(layerDefinitions(), key), {}}).values;
    }

    // And the layers that there are: others are taken out of all columns.
    void addDepositedByLayer() {
        std::vector<double>& deposited = columnOf("deposited_volume");
        deposited.assign(toolpath_.layer_count + std::size_t{1}, 0);
        for (const std::uint32_t bead : selection_)
            deposited.at(toolpath_.runOf(toolpath_.beads[bead]).layer) += gcode::laidVolume(toolpath_, bead);
        if (times_) {
            std::vector<double> seconds = times_->layers;
            seconds.resize(deposited.size(), 0);
            columnOf("time") = std::move(seconds);
        }
        const std::vector<double> present = columnOf("deposited_volume");
        for (std::uint32_t n = 0; n < present.size(); ++n)
            if (present[n] > 0) report_.layers.push_back(n);
        for (Column& column : report_.by_layer) {
            std::vector<double> kept;
            for (const std::uint32_t n : report_.layers) kept.push_back(column.values.at(n));
            column.values = std::move(kept);
        }
    }

    // Numbers come in the order of the work.
    void sortByDefinition() {
        const auto order = [](const auto& a, const auto& b) { return a.definition < b.definition; };
        std::sort(report_.numbers.begin(), report_.numbers.end(), order);
        std::sort(report_.left_out.begin(), report_.left_out.end(), order);
        std::sort(report_.by_layer.begin(), report_.by_layer.end(), order);
    }

    const openvdb::FloatGrid& grid_;
    const gcode::Toolpath& toolpath_;
    const std::span<const std::uint32_t> selection_;
    const voxelize::Lattice& lattice_;
    const std::optional<motion::PrintTimes>& times_;
    const ReportOptions& o_;
    PrintReport report_;
    double deposited_ = 0;        // mm^3
    std::optional<double> mass_;  // g
    double plastic_ = 0;          // mm^3
};

}  // namespace

const Number* PrintReport::find(std::string_view key) const {
    for (const Number& number : numbers)
        if (number.definition->key == key) return &number;
    return nullptr;
}

const Column* PrintReport::findColumn(std::string_view key) const {
    for (const std::vector<Column>* columns : {&by_layer, &by_slab})
        for (const Column& column : *columns)
            if (column.definition->key == key) return &column;
    return nullptr;
}

PrintReport makeReport(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                       std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                       const std::optional<motion::PrintTimes>& times, const ReportOptions& options) {
    return Report(grid, toolpath, selection, lattice, times, options).make();
}

nlohmann::ordered_json reportOf(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                                const std::optional<motion::PrintTimes>& times, const ReportOptions& options) {
    return toJson(makeReport(grid, toolpath, selection, lattice, times, options));
}

}  // namespace stratum::report
