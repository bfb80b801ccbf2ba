#include "trace_objects.h"

#include "brick_picture.h"
#include "command_line.h"
#include "progress.h"

#include "io/error.h"
#include "march/annotation.h"
#include "march/attribute_grid.h"
#include "march/brick_grid.h"
#include "march/brick_intersector.h"
#include "march/detail_intersector.h"
#include "march/grid_axes.h"
#include "march/level_set_file.h"
#include "march/sdf_grid.h"
#include "march/sdf_intersector.h"
#include "march/sphere_intersector.h"
#include "march/vdb_intersector.h"
#include "march/wide_intersector.h"
#include "ondemand/print_attributes.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;
using Want = std::tuple<std::string, std::string, std::string>;  // file, grid, attribute
using IntersectorPtr = std::shared_ptr<const march::Intersector>;

// What the file says its world unit is; other programs' files don't say.
std::string unitOf(const openvdb::FloatGrid& grid) {
    const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit");
    return unit ? unit->value() : "world units";
}

// Which axis the file says points up; files of other programs don't say.
std::string upOf(const openvdb::FloatGrid& grid) {
    const auto up = grid.getMetadata<openvdb::StringMetadata>("up");
    return up ? up->value() : "z";
}

// Space of the file -> that space with z up -> world.
march::Placement upright(const march::Placement& placement) {
    march::Placement result = placement;
    result.linear *= march::Placement::of(glm::dvec3(1.0), {90.0, 0.0, 0.0}, glm::dvec3(0.0)).linear;
    return result;
}

bool marchesBricks(const TraceOptions& options) { return options.march == "auto" || options.march == "brick"; }

IntersectorPtr intersectorOf(const openvdb::FloatGrid::ConstPtr& grid, const TraceOptions& options) {
    if (options.march == "vdb") return march::makeVdbIntersector(grid);
    if (options.march == "sphere") return march::makeSphereIntersector(grid);
    return march::makeBrickIntersector(*grid, options.values);
}

void warnOfThinBand(const std::string& path, const openvdb::FloatGrid& grid) {
    const double half_width = static_cast<double>(grid.background()) / march::GridAxes(grid.transform()).shortest();
    // Rounding of the background to a float is no reason to warn.
    if (half_width >= 2.999) return;
    fmt::print(stderr,
               "vdbtrace: {}: the narrow band is {:.2f} voxels to each side; with less than 3, surfaces that bend "
               "sharply may have holes; make it again with gcode2vdb --half-width 3\n",
               path, half_width);
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
    std::shared_ptr<march::Intersector> rays;

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
    std::map<std::string, march::AttributeSummary> summaries;
    Json report;
    std::string line;
};

class Reader {
public:
    Reader(const TraceOptions& options, std::vector<std::string> attributes, std::vector<Want> wants,
           TraceObjects& result)
        : options_(options), attributes_(std::move(attributes)), wants_(std::move(wants)), result_(result) {}

    const Shape& shapeOf(const shade::ObjectOptions& object) {
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
    Shape fromSdf(const shade::ObjectOptions& object) const {
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
            shape.intersector = march::makeSdfIntersector(object.sdf, object.tolerance);
            shape.report["tolerance"] = object.tolerance;
            shape.line = fmt::format("shape: traced by its formula, tolerance {:g}", object.tolerance);
        }
        return shape;
    }

    Shape fromFile(const shade::ObjectOptions& object) {
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
        march::Annotation annotation;
        for (const std::string& name : attributes_) {
            openvdb::GridBase::ConstPtr attribute;
            if (wanted(object, name)) {
                attribute = march::readAttributeGrid(object.vdb, name, head);
                shape.summaries[name] = march::summarize(*attribute);
            }
            annotation.attributes.push_back(march::makeAttributeSource(attribute));
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

    Shape fromPrint(const shade::ObjectOptions& object) {
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
        for (const std::string& name : attributes_)
            if (wanted(object, name))
                shape.summaries[name] =
                    ondemand::summarize(*print.levels.back().field, ondemand::attributeNamed(name), print.selection);
        // Each has its share of what they may take together.
        std::size_t cache = options_.brick_cache;
        if (cache != march::BrickGrid::kNoBound) cache /= print.levels.size() + print.wide.size();
        std::vector<LateBricks> bricks;
        shape.intersector = raysOf(object, print.levels, print.eye, cache, bricks);
        if (!print.wide.empty())
            shape.intersector = march::makeWideIntersector(
                shape.intersector, raysOf(object, print.wide, print.eye, cache, bricks), print.wide_from);
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
    IntersectorPtr raysOf(const shade::ObjectOptions& object, const std::vector<TracedLevel>& levels,
                          const glm::dvec3& eye, std::size_t cache, std::vector<LateBricks>& bricks) const {
        std::vector<march::DetailLevel> shapes;
        for (const TracedLevel& level : levels) {
            std::shared_ptr<march::Intersector> plain = march::makeBrickIntersector(
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
        return march::makeDetailIntersector(std::move(shapes), eye);
    }

    // The picture's name with the level's number, the finest first.
    static std::string ofLevel(const std::string& path, std::size_t level) {
        const std::filesystem::path name(path);
        return (name.parent_path() / fmt::format("{}_{}{}", name.stem().string(), level, name.extension().string()))
            .string();
    }

    // Another object of the same file may want it, too: then it is read for both.
    bool wanted(const shade::ObjectOptions& object, const std::string& name) const {
        return std::find(wants_.begin(), wants_.end(), Want(object.vdb, object.grid, name)) != wants_.end();
    }

    const TraceOptions& options_;
    std::vector<std::string> attributes_;
    std::vector<Want> wants_;
    TraceObjects& result_;
    Stopwatch watch_;
    std::vector<std::unique_ptr<Shape>> shapes_;
    std::map<std::pair<std::string, std::string>, const Shape*> files_;
};

}  // namespace

TraceObjects readTraceObjects(const std::vector<shade::ObjectOptions>& objects, const TraceOptions& options) {
    openvdb::initialize();
    TraceObjects result;
    std::vector<shade::MaterialOptions> materials;
    std::vector<std::string> attributes;
    std::vector<Want> wants;
    for (const shade::Label label : options.labels) {
        result.labels[static_cast<std::size_t>(label)] = attributes.size();
        attributes.emplace_back(shade::labelName(label));
        for (const shade::ObjectOptions& object : objects)
            if (!object.sdf) wants.emplace_back(object.vdb, object.grid, attributes.back());
    }
    bool own_materials = false;
    for (const shade::ObjectOptions& object : objects) {
        shade::MaterialOptions material = object.material;
        if (material.by.empty() && material.brdf.empty() && !object.sdf) material.by = options.color_by;
        if (!material.by.empty()) {
            if (std::find(attributes.begin(), attributes.end(), material.by) == attributes.end())
                attributes.push_back(material.by);
            wants.emplace_back(object.vdb, object.grid, material.by);
        }
        own_materials = own_materials || !material.by.empty() || !material.brdf.empty();
        materials.push_back(std::move(material));
    }
    Reader reader(options, attributes, std::move(wants), result);
    std::map<std::string, std::shared_ptr<const shade::Brdf>> brdfs;
    std::vector<march::SceneObject> scene;
    result.reports = Json::array();
    for (std::size_t n = 0; n < objects.size(); ++n) {
        const Shape& shape = reader.shapeOf(objects[n]);
        const bool y_up = objects[n].up.empty() ? shape.y_up : objects[n].up == "y";
        scene.push_back({shape.intersector, y_up ? upright(objects[n].placement) : objects[n].placement});
        if (n == 0) result.mm_per_unit = shape.mm_per_unit;
        result.reports.push_back(shape.report);
        if (std::find(result.lines.begin(), result.lines.end(), shape.line) == result.lines.end())
            result.lines.push_back(shape.line);
        if (!own_materials) continue;
        const shade::MaterialOptions& material = materials[n];
        if (material.by.empty()) {
            const std::string& text = material.brdf.empty() ? options.brdf : material.brdf;
            auto& brdf = brdfs[text];  // baking a table takes a second
            if (!brdf) brdf = shade::makeBrdf(text);
            result.materials.emplace_back(brdf);
            continue;
        }
        const auto number = std::find(attributes.begin(), attributes.end(), material.by) - attributes.begin();
        result.materials.push_back(shade::makeObjectMaterial(material, options.brdf, static_cast<std::size_t>(number),
                                                             shape.summaries.at(material.by)));
    }
    result.intersector = march::makeSceneIntersector(std::move(scene));
    return result;
}

}  // namespace stratum::tools
