// One grid of a file, one print, or one shape by formula, ready for rays.
#pragma once

#include "assemble/file/object_file.h"
#include "assemble/print/lazy_print.h"
#include "assemble/print/print_colors.h"
#include "assemble/shape/attribute_needs.h"
#include "assemble/shape/tracing_options.h"
#include "trace/attribute.h"
#include "trace/intersector.h"

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace stratum::assemble {

/// In the space of its file.
struct Shape {
    bool y_up = false;         ///< as the file states
    double mm_per_unit = 1.0;  ///< as the file states
    std::shared_ptr<const trace::Intersector> intersector;
    std::map<std::string, trace::AttributeSummary> summaries;  ///< of the attributes that it must provide
    std::optional<trace::Box> part;                            ///< without what is printed beside it, if that is known
    std::vector<glm::dvec3> outline;                           ///< points around the part; none: the corners of its box
    PrintColors colors;                                        ///< that the file states, if they are used
    std::string source;                                        ///< identifies the file, if asked for
    nlohmann::ordered_json report;
    std::string line;                  ///< for people
    std::shared_ptr<LazyPrint> print;  ///< of G-code; else null
    double load_seconds = 0.0, build_seconds = 0.0;
};

/// Throw InputError, UsageError.
Shape shapeOfSdf(const ObjectOptions& object, const TracingOptions& options);
Shape shapeOfLevelSet(const ObjectOptions& object, const TracingOptions& options, const AttributeNeeds& needs,
                      Warnings& warnings);
/// Adds the attribute "color" to the needs of the object if its file's colors depend on the position.
Shape shapeOfPrint(const ObjectOptions& object, const TracingOptions& options, AttributeNeeds& needs,
                   Warnings& warnings);

/// Whether the method lays level sets out in bricks.
bool marchesBricks(MarchMethod method);

/// The intersector of a grid, by options.march. Throws InputError for grids that can't be traced.
std::shared_ptr<const trace::Intersector> intersectorOf(const openvdb::FloatGrid::ConstPtr& grid,
                                                        const TracingOptions& options);

}  // namespace stratum::assemble
