#include "assemble/shape/shape.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "ondemand/print_attributes.h"
#include "trace/detail_intersector.h"

#include <fmt/format.h>

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
    return annotation;
}

}  // namespace

Shape shapeOfPrint(const ObjectOptions& object, const TracingOptions& options, AttributeNeeds& needs,
                   Warnings& warnings) {
    if (!marchesBricks(options.march))
        throw UsageError(
            fmt::format("--march {}: needs a level set; make one of {} with gcode2vdb, or take --march brick",
                        marchMethodName(options.march), object.vdb));
    Stopwatch watch;
    PrintRequest request = options.prints;
    for (const std::string& name : needs.names())
        if (needs.contains(object, name))
            request.timed = request.timed || voxelize::usesTiming(ondemand::attributeNamed(name));
    PrintLevels print = readPrintLevels(object.vdb, request, options.hash, options.events, warnings);
    Shape shape;
    shape.report = std::move(print.report);
    shape.line = std::move(print.line);
    shape.part = boxOf(print.part);
    shape.source = std::move(print.content);
    if (needs.needsStatedColors(object)) {
        shape.colors = colorsOf(*print.toolpath, print.selection);
        if (shape.colors.by_place) needs.add(object, "color");
    }
    for (const std::string& name : needs.names())
        if (needs.contains(object, name))
            shape.summaries[name] =
                ondemand::summarize(*print.levels.back().field, ondemand::attributeNamed(name), print.selection);
    // All levels together keep to the bound.
    std::size_t cache = options.brick_cache;
    if (cache != march::BrickGrid::kNoBound) cache /= print.levels.size();
    std::vector<LazyLevel> lazy;
    std::vector<trace::DetailLevel> shapes;
    for (const PrintLevel& level : print.levels) {
        march::TracedBricks traced =
            march::makeTracedBricks(std::shared_ptr<const march::LeafField>(level.field), options.values, cache);
        shapes.push_back(
            {march::annotate(std::move(traced.intersector), annotationOf(object, level.field, options, needs)),
             level.from});
        lazy.push_back({level.field, std::move(traced.bricks)});
    }
    shape.intersector = trace::makeDetailIntersector(std::move(shapes), print.eye);
    const double seconds = watch.lap();
    shape.load_seconds = print.parse_seconds;
    shape.build_seconds = seconds - print.parse_seconds;
    shape.print = std::make_shared<LazyPrint>(std::move(lazy), std::move(print.moments),
                                              LazyPrint::Times{print.parse_seconds, seconds}, cache);
    return shape;
}

}  // namespace stratum::assemble
