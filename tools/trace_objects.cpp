#include "trace_objects.h"

#include "brick_picture.h"
#include "command_line.h"
#include "file_facts.h"
#include "progress.h"
#include "trace_materials.h"

#include "base/error.h"
#include "march/attribute/annotation.h"
#include "march/attribute/attribute_grid.h"
#include "march/brick/brick_grid.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "march/file/sdf_grid.h"
#include "march/reference/sphere_intersector.h"
#include "march/reference/vdb_intersector.h"
#include "ondemand/print_attributes.h"
#include "shade/brdf/filament_color.h"
#include "trace/detail_intersector.h"
#include "trace/sdf_intersector.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;
using Want = std::tuple<std::string, std::string, std::string>;  // file, grid, attribute
using IntersectorPtr = std::shared_ptr<const trace::Intersector>;

// Space of the file -> that space with z up -> world.
trace::Placement upright(const trace::Placement& placement) {
    trace::Placement result = placement;
    result.linear *= trace::Placement::of(glm::dvec3(1.0), {90.0, 0.0, 0.0}, glm::dvec3(0.0)).linear;
    return result;
}

bool marchesBricks(const TraceOptions& options) { return options.march == "auto" || options.march == "brick"; }

IntersectorPtr intersectorOf(const openvdb::FloatGrid::ConstPtr& grid, const TraceOptions& options) {
    if (options.march == "vdb") return march::makeVdbIntersector(grid);
    if (options.march == "sphere") return march::makeSphereIntersector(grid);
    return march::makeBrickIntersector(*grid, options.values);
}

Json reportOf(const march::BrickSlots& cache, const march::BrickGrid& bricks, std::size_t limit) {
    Json report{{"limit_bytes", limit}, {"holds_all", !cache.bounded()}};
    if (!cache.bounded()) return report;
    const march::BrickCacheCounts counts = cache.counts();
    report["bricks"] = counts.slots;
    report["hits"] = counts.hits;
    report["made"] = counts.made;
    report["evicted"] = counts.evicted;
    report["peak_bytes"] = counts.peak * bricks.brickBytes();
    return report;
}

/// A print at one voxel size, ready for rays.
struct LateBricks {
    std::shared_ptr<ondemand::PrintField> field;
    std::shared_ptr<trace::Intersector> rays;

    march::BrickGrid& grid() const { return *march::bricksOf(*rays); }
};

Json reportOf(const LateBricks& level, std::size_t cache_bytes) {
    const march::BrickGrid& bricks = level.grid();
    Json report{{"voxel_size_mm", level.field->layout().lattice.voxel_size},
                {"bricks_listed", bricks.listedCount()},
                {"bricks_made", bricks.brickCount()},
                {"leaves_made", level.field->leavesMade()},
                {"print_bytes", level.field->bytes()},
                {"brick_bytes", bricks.bytes()}};
    if (cache_bytes != march::BrickGrid::kNoBound)
        report["brick_cache"] = reportOf(bricks.cache(), bricks, cache_bytes);
    return report;
}

// What the bricks of a print took, after those of `before`: of each level, and all together.
std::function<Json()> reportOf(std::vector<LateBricks> levels, double parse, double seconds, std::size_t cache_bytes,
                               std::function<Json()> before) {
    return [levels = std::move(levels), parse, seconds, cache_bytes, before = std::move(before)] {
        Json all = before ? before() : Json::array();
        ondemand::PrintFieldTimes times;
        double bricks_seconds = 0;
        Json reports = Json::array();
        for (const LateBricks& level : levels) {
            times.bins += level.field->times().bins;
            times.box += level.field->times().box;
            times.map += level.field->times().map;
            bricks_seconds += level.grid().layoutSeconds();
            reports.push_back(reportOf(level, cache_bytes));
        }
        const auto sum = [&reports](const char* what) {
            std::size_t result = 0;
            for (const Json& report : reports) result += report[what].get<std::size_t>();
            return result;
        };
        const ondemand::PrintField& field = *levels.front().field;
        all.push_back({{"print", field.name()},
                       {"seconds",
                        {{"parse", parse},
                         {"bins", times.bins},
                         {"box", times.box},
                         {"map", times.map},
                         {"list", seconds - parse - times.bins - times.box - times.map},
                         {"bricks_all_threads", bricks_seconds}}},
                       {"bricks_listed", sum("bricks_listed")},
                       {"bricks_made", sum("bricks_made")},
                       {"leaves_made", sum("leaves_made")},
                       {"printed_beads", std::min<std::size_t>(field.printed(), field.layout().toolpath->beads.size())},
                       {"print_bytes", sum("print_bytes")},
                       {"brick_bytes", sum("brick_bytes")}});
        if (levels.size() > 1)
            all.back()["levels"] = reports;
        else if (reports.front().contains("brick_cache"))
            all.back()["brick_cache"] = reports.front()["brick_cache"];
        return all;
    };
}

/// What is made of one grid of one file, or of one shape.
struct Shape {
    // By the file's own word.
    bool y_up = false;
    double mm_per_unit = 1.0;
    IntersectorPtr intersector;
    std::map<std::string, trace::AttributeSummary> summaries;
    std::optional<trace::Box> part;  // own space, without what is printed beside it
    PrintColors colors;              // if somebody wants to know
    std::string source;              // what tells the file from others
    Json report;
    std::string line;
};

// Makes the box of all parts larger by that of a shape where it stands: of all of it, if its file doesn't say more.
void include(std::optional<trace::Box>& parts, const Shape& shape, const trace::Placement& placement) {
    const trace::Box own = shape.part.value_or(shape.intersector->bounds());
    if (!std::isfinite(glm::dot(own.max - own.min, glm::dvec3(1.0)))) return;  // a shape by formula may have no end
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1) != 0 ? own.max.x : own.min.x, (corner & 2) != 0 ? own.max.y : own.min.y,
                               (corner & 4) != 0 ? own.max.z : own.min.z);
        const glm::dvec3 world = placement.linear * place + placement.offset;
        if (!parts) parts = trace::Box{world, world};
        parts->min = glm::min(parts->min, world);
        parts->max = glm::max(parts->max, world);
    }
}

class Reader {
public:
    Reader(const TraceOptions& options, std::vector<std::string> attributes, std::vector<Want> wants,
           std::set<std::pair<std::string, std::string>> by_file, TraceObjects& result)
        : options_(options),
          attributes_(std::move(attributes)),
          wants_(std::move(wants)),
          by_file_(std::move(by_file)),
          result_(result) {}

    const Shape& shapeOf(const assemble::ObjectOptions& object) {
        if (object.sdf) {
            watch_.lap();
            shapes_.push_back(std::make_unique<Shape>(fromSdf(object)));
            result_.build_seconds += watch_.lap();
            return *shapes_.back();
        }
        auto& known = files_[{object.vdb, object.grid}];
        if (known == nullptr) {
            shapes_.push_back(std::make_unique<Shape>(fromFile(object)));
            known = shapes_.back().get();
        }
        return *known;
    }

private:
    Shape fromSdf(const assemble::ObjectOptions& object) const {
        Shape shape;
        shape.report = {{"sdf", true}};
        if (object.voxel_size > 0.0) {
            const openvdb::FloatGrid::ConstPtr grid = march::makeSdfGrid(*object.sdf, object.voxel_size);
            shape.report["active_voxels"] = grid->activeVoxelCount();
            shape.line = fmt::format("shape: {} active voxels of {:g}",
                                     humanCount(static_cast<double>(grid->activeVoxelCount())), object.voxel_size);
            march::Annotation annotation;
            if (options_.smooth_normals) annotation.smooth = grid;
            shape.intersector = march::annotate(intersectorOf(grid, options_), std::move(annotation));
        } else {
            shape.intersector = trace::makeSdfIntersector(object.sdf, object.tolerance);
            shape.report["tolerance"] = object.tolerance;
            shape.line = fmt::format("shape: traced by its formula, tolerance {:g}", object.tolerance);
        }
        return shape;
    }

    Shape fromFile(const assemble::ObjectOptions& object) {
        if (!isVdbFile(object.vdb)) return fromPrint(object);
        watch_.lap();
        Shape shape;
        // Bricks are laid out from the file as rays come to them, unless something else wants the grid.
        std::shared_ptr<const march::LeafFile> file;
        openvdb::FloatGrid::ConstPtr grid;
        {
            const ProgressNote note("loading", options_.prints.quiet);
            if (marchesBricks(options_) && !options_.smooth_normals)
                file = march::openLevelSet(object.vdb, object.grid);
            if (!file) grid = march::readLevelSet(object.vdb, object.grid);
        }
        const openvdb::FloatGrid& head = file ? file->head() : *grid;
        const std::uint64_t active = file ? file->activeVoxelCount() : grid->activeVoxelCount();
        shape.report = {{"path", object.vdb},
                        {"grid", head.getName()},
                        {"active_voxels", active},
                        {"bytes", file ? 0 : grid->memUsage()}};
        shape.line = fmt::format("{}: {} active voxels of {:g} {}", object.vdb, humanCount(static_cast<double>(active)),
                                 head.voxelSize()[0], unitOf(head));
        shape.y_up = upOf(head) == "y";
        shape.mm_per_unit = millimetresIn(unitOf(head));
        warnOfThinBand(object.vdb, head);
        shape.part = partOf(head);
        if (options_.prints.hash) shape.source = identityOf(object.vdb);
        march::Annotation annotation;
        for (const std::string& name : attributes_) {
            openvdb::GridBase::ConstPtr attribute;
            if (wanted(object, name)) {
                attribute = march::readAttributeGrid(object.vdb, name, head);
                shape.summaries[name] = march::summarize(*attribute);
            }
            annotation.attributes.push_back(march::makeAttributeSource(attribute));
        }
        if (asksFile(object)) {
            shape.colors = colorsOf(object.vdb, head);
            if (shape.colors.by_place) addColorGrid(object, head, shape, annotation);
        }
        if (options_.smooth_normals) annotation.smooth = grid;
        result_.load_seconds += watch_.lap();
        const ProgressNote note("laying out", options_.prints.quiet);
        const IntersectorPtr plain =
            file ? march::makeBrickIntersector(std::move(file), options_.values, options_.brick_cache)
                 : intersectorOf(grid, options_);
        grid.reset();  // bricks hold all that rays need
        shape.intersector = march::annotate(plain, std::move(annotation));
        result_.build_seconds += watch_.lap();
        return shape;
    }

    // The grid of colours that lies beside a level set, unless all of it is of one: then that is enough.
    void addColorGrid(const assemble::ObjectOptions& object, const openvdb::FloatGrid& head, Shape& shape,
                      march::Annotation& annotation) const {
        shape.colors.by_place = false;
        openvdb::GridBase::ConstPtr grid;
        try {
            grid = march::readAttributeGrid(object.vdb, "color", head);
        } catch (const InputError&) {
            return;  // another program's, of another kind: nobody asked for it
        }
        trace::AttributeSummary summary = march::summarize(*grid);
        if (summary.kind != trace::AttributeSummary::Kind::color) return;
        for (const glm::vec3& color : summary.colors) {
            if (color == trace::kNoColor) continue;
            shape.colors.stated.push_back(shade::hexOf(color));
            shape.colors.report.push_back({{"color", shape.colors.stated.back()}, {"from", "the grid color"}});
        }
        if (summary.colors.size() < 2 || shape.colors.stated.empty()) return;
        shape.colors.by_place = true;
        const auto place = std::find(attributes_.begin(), attributes_.end(), "color") - attributes_.begin();
        annotation.attributes[static_cast<std::size_t>(place)] = march::makeAttributeSource(grid);
        shape.summaries["color"] = std::move(summary);
    }

    Shape fromPrint(const assemble::ObjectOptions& object) {
        if (!marchesBricks(options_))
            throw UsageError(
                fmt::format("--march {}: needs a level set; make one of {} with gcode2vdb, or take --march "
                            "brick",
                            options_.march, object.vdb));
        watch_.lap();
        TracePrintOptions prints = options_.prints;
        for (const std::string& name : attributes_)
            if (wanted(object, name)) prints.timed = prints.timed || name == "time" || name == "speed";
        TracedPrint print = readTracedPrint(object.vdb, prints);
        Shape shape;
        shape.report = print.report;
        shape.line = print.line;
        shape.part = trace::Box{{print.part.min[0], print.part.min[1], print.part.min[2]},
                                {print.part.max[0], print.part.max[1], print.part.max[2]}};
        shape.source = print.content;
        if (asksFile(object)) {
            shape.colors = colorsOf(*print.toolpath, print.selection);
            if (shape.colors.by_place) wants_.emplace_back(object.vdb, object.grid, "color");
        }
        for (const std::string& name : attributes_)
            if (wanted(object, name))
                shape.summaries[name] =
                    ondemand::summarize(*print.levels.back().field, ondemand::attributeNamed(name), print.selection);
        // Each has its share of what they may take together.
        std::size_t cache = options_.brick_cache;
        if (cache != march::BrickGrid::kNoBound) cache /= print.levels.size();
        std::vector<LateBricks> bricks;
        shape.intersector = raysOf(object, print.levels, print.eye, cache, bricks);
        const double seconds = watch_.lap();
        result_.load_seconds += print.parse_seconds;
        result_.build_seconds += seconds - print.parse_seconds;
        if (print.moments.size() > 1) {
            result_.moments = print.moments.size();
            result_.showMoment = [bricks, moments = print.moments](std::size_t n) {
                for (const LateBricks& level : bricks) level.grid().update(level.field->printUntil(moments[n]));
            };
        }
        result_.writeBrickPicture = [bricks](const std::string& path) {
            for (std::size_t n = 0; n < bricks.size(); ++n)
                tools::writeBrickPicture(bricks.size() == 1 ? path : ofLevel(path, n), bricks[n].grid());
        };
        result_.on_demand = reportOf(bricks, print.parse_seconds, seconds, cache, result_.on_demand);
        return shape;
    }

    // All levels of a print as one; what is behind each is added to `bricks`.
    IntersectorPtr raysOf(const assemble::ObjectOptions& object, const std::vector<TracedLevel>& levels,
                          const glm::dvec3& eye, std::size_t cache, std::vector<LateBricks>& bricks) const {
        std::vector<trace::DetailLevel> shapes;
        for (const TracedLevel& level : levels) {
            std::shared_ptr<trace::Intersector> plain = march::makeBrickIntersector(
                std::shared_ptr<const march::LeafField>(level.field), options_.values, cache);
            march::Annotation annotation;
            for (const std::string& name : attributes_)
                annotation.attributes.push_back(
                    wanted(object, name) ? ondemand::makePrintAttribute(level.field, ondemand::attributeNamed(name))
                                         : nullptr);
            if (options_.smooth_normals) annotation.smooth_field = level.field;
            shapes.push_back({march::annotate(plain, std::move(annotation)), level.from});
            bricks.push_back({level.field, std::move(plain)});
        }
        return trace::makeDetailIntersector(std::move(shapes), eye);
    }

    // The picture's name with the level's number, the finest first.
    static std::string ofLevel(const std::string& path, std::size_t level) {
        const std::filesystem::path name(path);
        return (name.parent_path() / fmt::format("{}_{}{}", name.stem().string(), level, name.extension().string()))
            .string();
    }

    // Another object of the same file may want it, too: then it is read for both.
    bool wanted(const assemble::ObjectOptions& object, const std::string& name) const {
        return std::find(wants_.begin(), wants_.end(), Want(object.vdb, object.grid, name)) != wants_.end();
    }

    // Whether nobody says what it is made of, so that its file may.
    bool asksFile(const assemble::ObjectOptions& object) const { return by_file_.contains({object.vdb, object.grid}); }

    const TraceOptions& options_;
    std::vector<std::string> attributes_;
    std::vector<Want> wants_;
    std::set<std::pair<std::string, std::string>> by_file_;
    TraceObjects& result_;
    Stopwatch watch_;
    std::vector<std::unique_ptr<Shape>> shapes_;
    std::map<std::pair<std::string, std::string>, const Shape*> files_;
};

}  // namespace

TraceObjects readTraceObjects(const std::vector<assemble::ObjectOptions>& objects, const TraceOptions& options) {
    openvdb::initialize();
    TraceObjects result;
    std::vector<shade::MaterialOptions> materials;
    std::vector<std::string> attributes;
    std::vector<Want> wants;
    for (const shade::Label label : options.labels) {
        result.labels[static_cast<std::size_t>(label)] = attributes.size();
        attributes.emplace_back(shade::labelName(label));
        for (const assemble::ObjectOptions& object : objects)
            if (!object.sdf) wants.emplace_back(object.vdb, object.grid, attributes.back());
    }
    std::set<std::pair<std::string, std::string>> by_file;
    const auto number = [&attributes](const std::string& name) {
        const auto found = std::find(attributes.begin(), attributes.end(), name);
        const auto place = static_cast<std::size_t>(found - attributes.begin());
        if (found == attributes.end()) attributes.push_back(name);
        return place;
    };
    for (const assemble::ObjectOptions& object : objects) {
        shade::MaterialOptions material = object.material;
        if (material.by.empty() && material.brdf.empty() && !object.sdf) {
            material.by = options.color_by;
            if (options.file_colors && material.by.empty()) {
                by_file.emplace(object.vdb, object.grid);
                (void)number("color");
            }
        }
        if (!material.by.empty()) {
            (void)number(material.by);
            wants.emplace_back(object.vdb, object.grid, material.by);
        }
        materials.push_back(std::move(material));
    }
    Reader reader(options, attributes, std::move(wants), by_file, result);
    TraceMaterials made(options.brdf);
    std::vector<trace::SceneObject> scene;
    std::optional<trace::Box> parts;
    bool any_part = false;
    result.reports = Json::array();
    for (std::size_t n = 0; n < objects.size(); ++n) {
        const Shape& shape = reader.shapeOf(objects[n]);
        const bool y_up = objects[n].up.empty() ? shape.y_up : objects[n].up == "y";
        scene.push_back({shape.intersector, y_up ? upright(objects[n].placement) : objects[n].placement});
        include(parts, shape, scene.back().placement);
        any_part = any_part || shape.part.has_value();
        if (n == 0) result.mm_per_unit = shape.mm_per_unit;
        result.reports.push_back(shape.report);
        if (!shape.source.empty()) result.source += " " + shape.source;
        if (std::find(result.lines.begin(), result.lines.end(), shape.line) == result.lines.end())
            result.lines.push_back(shape.line);
        const shade::MaterialOptions& material = materials[n];
        const bool asks = material.by.empty() && material.brdf.empty() && !objects[n].sdf && options.file_colors;
        const std::string by = asks ? "color" : material.by;
        const auto summary = shape.summaries.find(by);
        const trace::AttributeSummary* const known = summary == shape.summaries.end() ? nullptr : &summary->second;
        if (asks)
            made.add(shape.colors, number(by), shape.colors.by_place ? known : nullptr);
        else
            made.add(material, by.empty() ? 0 : number(by), by.empty() ? nullptr : known);
    }
    if (any_part) result.part = parts;
    result.materials = made.materials();
    result.brdf = made.brdf();
    result.material = made.report();
    result.legends = made.legends();
    result.no_color_lookup = made.noLookup();
    result.intersector = trace::makeSceneIntersector(std::move(scene));
    return result;
}

}  // namespace stratum::tools
