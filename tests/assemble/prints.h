// Options and files of the tests of this room: prints and level sets that are quick to read.
#pragma once

#include "assemble/traced_objects.h"
#include "corpus.h"
#include "spheres.h"

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>

namespace stratum::test {

/// Voxels as large as a layer: enough to hit something.
inline assemble::TracingOptions coarseTracing() {
    assemble::TracingOptions options;
    options.prints.print.lattice.voxel_size = 0.2;
    return options;
}

inline assemble::ObjectOptions objectOf(const std::filesystem::path& path) { return {.vdb = path.string()}; }

inline assemble::ObjectOptions printOf(const std::string& name) { return objectOf(sourceDir() / "data/gcode" / name); }

/// A level set of a sphere about (1, 2, 3) as a file. Returns its path.
inline std::filesystem::path writeSphere(const std::filesystem::path& path, float half_width = 3) {
    openvdb::initialize();
    const openvdb::FloatGrid::Ptr grid = sphereGrid(2, {1, 2, 3}, 0.2F, half_width);
    grid->insertMeta("unit", openvdb::StringMetadata("cm"));
    grid->insertMeta("filament_color", openvdb::StringMetadata("#00ff00"));
    openvdb::io::File(path.string()).write({grid});
    return path;
}

/// Whether a ray straight down meets something there.
inline bool hitsFromAbove(const trace::Intersector& shape, double x, double y) {
    trace::Ray ray;
    ray.origin = {x, y, shape.bounds().max.z + 1};
    ray.direction = {0, 0, -1};
    trace::Hit hit;
    return shape.makeTracer()->intersect(ray, hit);
}

}  // namespace stratum::test
