#include "assemble/print/kept_prints.h"
#include "assemble/shape/shape.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "ondemand/print_attributes.h"
#include "trace/detail_intersector.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

// The print's attributes by number; null where the object doesn't need it.
march::Annotation annotationOf(const ObjectOptions& object, const std::shared_ptr<ondemand::PrintField>& field,
                               const TracingOptions& options, const AttributeNeeds& needs) {
    march::Annotation annotation;
    for (const std::string& name : needs.names())
        annotation.attributes.push_back(needs.contains(object, name)
                                            ? ondemand::makePrintAttribute(field, ondemand::attributeNamed(name))
                                            : nullptr);
    if (options.smooth_normals) annotation.smooth_field = field;
    if (needs.needsGrain(object)) annotation.grain = ondemand::makePrintGrain(field);
    return annotation;
}

// Reads a selection of a print, and lists its bricks; or takes what is kept of it.
std::shared_ptr<TracedPrint> tracedOf(const ObjectOptions& object, const PrintRequest& request,
                                      const TracingOptions& options, Warnings& warnings) {
    const bool keep = request.kept != nullptr && !request.print.voxel_auto;
    if (keep)
        if (auto known = request.kept->print(object.vdb, request, request.timed)) return known;
    Stopwatch watch;
    auto traced = std::make_shared<TracedPrint>();
    PrintLevels& print = traced->print;
    print = readPrintLevels(object.vdb, request, options.hash, options.events, warnings);
    // All levels together keep to the bound.
    std::size_t cache = options.brick_cache;
    if (cache != march::BrickGrid::kNoBound) cache /= print.levels.size();
    std::vector<LazyLevel> lazy;
    for (const PrintLevel& level : print.levels) {
        march::TracedBricks bricks =
            march::makeTracedBricks(std::shared_ptr<const march::LeafField>(level.field), options.values, cache);
        traced->shapes.push_back(std::move(bricks.intersector));
        lazy.push_back({level.field, std::move(bricks.bricks)});
    }
    traced->lazy = std::make_shared<LazyPrint>(std::move(lazy), print.moments, print.tips,
                                               LazyPrint::Times{print.parse_seconds, watch.lap()}, cache);
    if (keep) request.kept->keep(object.vdb, request, traced);
    return traced;
}

}  // namespace

Shape shapeOfPrint(const ObjectOptions& object, const TracingOptions& options, AttributeNeeds& needs,
                   Warnings& warnings) {
    if (!marchesBricks(options.march))
        throw UsageError(
            fmt::format("--march {}: needs a level set; make one of {} with gcode2vdb, or take --march brick",
                        nameOf(kMarchMethods, options.march), object.vdb));
    Stopwatch watch;
    PrintRequest request = options.prints;
    for (const std::string& name : needs.names())
        if (needs.contains(object, name))
            request.timed = request.timed || voxelize::usesTiming(ondemand::attributeNamed(name));
    const std::shared_ptr<TracedPrint> traced = tracedOf(object, request, options, warnings);
    const PrintLevels& print = traced->print;
    Shape shape;
    shape.report = print.report;
    shape.line = print.line;
    shape.part = boxOf(print.part);
    shape.outline = print.outline;
    shape.source = print.content;
    if (needs.needsStatedColors(object)) {
        shape.colors = colorsOf(*print.toolpath, print.selection, request.print.read.filament_colors);
        if (shape.colors.by_place) needs.add(object, "color");
    }
    for (const std::string& name : needs.names())
        if (needs.contains(object, name))
            shape.summaries[name] =
                ondemand::summarize(*print.levels.back().field, ondemand::attributeNamed(name), print.selection);
    std::vector<trace::DetailLevel> shapes;
    for (std::size_t n = 0; n < print.levels.size(); ++n)
        shapes.push_back(
            {march::annotate(traced->shapes[n], annotationOf(object, print.levels[n].field, options, needs)),
             print.levels[n].from});
    shape.intersector = trace::makeDetailIntersector(std::move(shapes), print.eye);
    const double seconds = watch.lap();
    shape.load_seconds = std::min(print.parse_seconds, seconds);
    shape.build_seconds = seconds - shape.load_seconds;
    if (request.kept == nullptr) traced->print.selection = {};
    // Whoever has it keeps all of the selection, for the next scene.
    shape.print = std::shared_ptr<LazyPrint>(traced, traced->lazy.get());
    return shape;
}

}  // namespace stratum::assemble
