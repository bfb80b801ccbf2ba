// Level sets, prints and shapes -> one intersector with materials, and reports about them.
#pragma once

#include "assemble/file/object_file.h"
#include "assemble/print/lazy_print.h"
#include "assemble/shape/tracing_options.h"
#include "shade/film/legend.h"
#include "shade/scene/material.h"
#include "shade/scene/scene.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

/// Lengths are in world units; TracedObjects::mm_per_unit says how long they are. The intersector may be shared by any
/// number of threads.
struct TracedObjects {
    std::shared_ptr<const trace::Intersector> intersector;
    std::vector<shade::ObjectMaterial> materials;  ///< by trace::Hit::object; empty if all are of the scene's
    decltype(shade::SceneDescription::labels) labels;
    std::string brdf;                ///< the scene's material, see ObjectMaterials::brdf()
    std::vector<std::string> brdfs;  ///< the materials in use, see ObjectMaterials::brdfs()
    std::vector<shade::Legend> legends;
    /// World-space box of the parts without what is printed beside them, if a file states it.
    std::optional<trace::Box> part;
    std::vector<glm::dvec3> outline;  ///< points around those parts, for cameras; empty: the corners of the box
    double mm_per_unit = 1.0;         ///< of world space, as the first object's file states
    /// Of each G-code file, in the order of their first objects: to show another moment of it, and to report its
    /// bricks.
    std::vector<std::shared_ptr<LazyPrint>> prints;

    std::vector<std::string> lines;          ///< of each file and shape, for people
    std::vector<Warning> warnings;           ///< in the order in which they occurred
    nlohmann::ordered_json reports;          ///< an array: facts of each object
    nlohmann::ordered_json material_report;  ///< materials, colours and legends
    std::string no_color_lookup;  ///< why hits need no color lookup; empty if they need one or have no colors
    std::string source;           ///< identifies the files, for checkpoints
    double load_seconds = 0.0, build_seconds = 0.0;
};

/// Reads every file once, even if several objects use it. Runs on the threads that TBB may use.
/// Throws InputError for files that can't be traced, UsageError for options that don't fit them.
TracedObjects readTracedObjects(const std::vector<ObjectOptions>& objects, const TracingOptions& options);

/// LazyPrint::report() of all prints: an array.
nlohmann::ordered_json onDemandReport(const TracedObjects& objects);

/// The last print that has more than one moment; null if there is none.
std::shared_ptr<LazyPrint> growingPrint(const TracedObjects& objects);

}  // namespace stratum::assemble
