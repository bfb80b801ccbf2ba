#include "assemble/file/file_facts.h"
#include "assemble/shape/shape.h"
#include "base/error.h"
#include "base/human_text.h"
#include "base/stopwatch.h"
#include "march/attribute/annotation.h"
#include "march/attribute/attribute_grid.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "march/file/sdf_grid.h"
#include "march/reference/reference_intersectors.h"
#include "shade/palette/filament_color.h"
#include "trace/sdf_intersector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace stratum::assemble {
namespace {

/// A level set before it is laid out: leaf by leaf in its file, whole in memory, or both.
struct LevelSet {
    std::shared_ptr<const march::LeafFile> file;
    openvdb::FloatGrid::ConstPtr grid;  // null if `file` is enough

    const openvdb::FloatGrid& head() const { return file ? file->head() : *grid; }
    std::uint64_t activeVoxelCount() const { return file ? file->activeVoxelCount() : grid->activeVoxelCount(); }
};

// Bricks are laid out lazily from the file, where it can be read so: also beside the grid that smooth normals look
// values up in, because rays come to a part of the bricks only.
LevelSet open(const ObjectOptions& object, const TracingOptions& options) {
    const Step step(options.events, "loading");
    LevelSet level_set;
    if (marchesBricks(options.march)) level_set.file = march::openLevelSet(object.vdb, object.grid);
    if (!level_set.file || options.smooth_normals) level_set.grid = march::readLevelSet(object.vdb, object.grid);
    return level_set;
}

void describe(const ObjectOptions& object, const LevelSet& level_set, Shape& shape) {
    const openvdb::FloatGrid& head = level_set.head();
    const std::uint64_t active = level_set.activeVoxelCount();
    shape.report = {{"path", object.vdb},
                    {"grid", head.getName()},
                    {"active_voxels", active},
                    {"bytes", level_set.grid ? level_set.grid->memUsage() : 0}};
    shape.line = fmt::format("{}: {} active voxels of {:g} {}", object.vdb, humanCount(static_cast<double>(active)),
                             head.voxelSize()[0], unitOf(head));
    shape.y_up = upOf(head) == "y";
    shape.mm_per_unit = voxelize::millimetresIn(unitOf(head));
    shape.part = partOf(head);
    if (shape.part) shape.outline = outlineOf(head);
}

// Attaches the grid "color" of the file, unless it has only one color: then the lookup is not needed.
void addColorGrid(const ObjectOptions& object, const openvdb::FloatGrid& head, const AttributeNeeds& needs,
                  Shape& shape, march::Annotation& annotation) {
    shape.colors.by_place = false;
    openvdb::GridBase::ConstPtr grid;
    try {
        grid = march::readAttributeGrid(object.vdb, "color", head);
    } catch (const InputError&) {
        return;  // another program's, of another type; it is optional
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
    const auto place = std::find(needs.names().begin(), needs.names().end(), "color") - needs.names().begin();
    annotation.attributes[static_cast<std::size_t>(place)] = march::makeAttributeSource(grid);
    shape.summaries["color"] = std::move(summary);
}

march::Annotation readAttributes(const ObjectOptions& object, const openvdb::FloatGrid& head,
                                 const AttributeNeeds& needs, Shape& shape) {
    march::Annotation annotation;
    for (const std::string& name : needs.names()) {
        openvdb::GridBase::ConstPtr attribute;
        if (needs.contains(object, name)) {
            attribute = march::readAttributeGrid(object.vdb, name, head);
            shape.summaries[name] = march::summarize(*attribute);
        }
        annotation.attributes.push_back(march::makeAttributeSource(attribute));
    }
    if (needs.needsStatedColors(object)) {
        shape.colors = colorsOf(object.vdb, head);
        if (shape.colors.by_place) addColorGrid(object, head, needs, shape, annotation);
    }
    return annotation;
}

}  // namespace

bool marchesBricks(MarchMethod method) { return method == MarchMethod::automatic || method == MarchMethod::brick; }

std::shared_ptr<const trace::Intersector> intersectorOf(const openvdb::FloatGrid::ConstPtr& grid,
                                                        const TracingOptions& options) {
    if (options.march == MarchMethod::vdb) return march::makeVdbIntersector(grid);
    if (options.march == MarchMethod::sphere) return march::makeSphereIntersector(grid);
    return march::makeBrickIntersector(*grid, options.values);
}

Shape shapeOfSdf(const ObjectOptions& object, const TracingOptions& options) {
    Stopwatch watch;
    Shape shape;
    shape.report = {{"sdf", true}};
    if (object.voxel_size > 0.0) {
        const openvdb::FloatGrid::ConstPtr grid = march::makeSdfGrid(*object.sdf, object.voxel_size);
        shape.report["active_voxels"] = grid->activeVoxelCount();
        shape.line = fmt::format("shape: {} active voxels of {:g}",
                                 humanCount(static_cast<double>(grid->activeVoxelCount())), object.voxel_size);
        march::Annotation annotation;
        if (options.smooth_normals) annotation.smooth = grid;
        shape.intersector = march::annotate(intersectorOf(grid, options), std::move(annotation));
    } else {
        shape.intersector = trace::makeSdfIntersector(object.sdf, object.tolerance);
        shape.report["tolerance"] = object.tolerance;
        shape.line = fmt::format("shape: traced by its formula, tolerance {:g}", object.tolerance);
    }
    shape.build_seconds = watch.lap();
    return shape;
}

Shape shapeOfLevelSet(const ObjectOptions& object, const TracingOptions& options, const AttributeNeeds& needs,
                      Warnings& warnings) {
    Stopwatch watch;
    Shape shape;
    LevelSet level_set = open(object, options);
    describe(object, level_set, shape);
    if (std::string thin = thinBandWarning(object.vdb, level_set.head()); !thin.empty())
        warnings.add(Warning::Kind::narrow_band, std::move(thin));
    if (options.hash) shape.source = identityOf(object.vdb);
    march::Annotation annotation = readAttributes(object, level_set.head(), needs, shape);
    if (options.smooth_normals) annotation.smooth = level_set.grid;
    shape.load_seconds = watch.lap();
    const Step step(options.events, "laying out");
    std::shared_ptr<const trace::Intersector> plain =
        level_set.file ? march::makeBrickIntersector(std::move(level_set.file), options.values, options.brick_cache)
                       : intersectorOf(level_set.grid, options);
    level_set.grid.reset();  // bricks hold all that rays need
    shape.intersector = march::annotate(std::move(plain), std::move(annotation));
    shape.build_seconds = watch.lap();
    return shape;
}

}  // namespace stratum::assemble
