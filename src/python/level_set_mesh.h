// The surface of a level set as arrays of polygons.
#pragma once

#include "python/level_set_object.h"

#include <pybind11/pybind11.h>

namespace stratum::python {

/// A Mesh: vertices, triangles, and a color a vertex where the level set has the grid "color".
/// @param mesh_error  voxels, 0 to 2
/// @param outside_only  without the surfaces of cavities
/// Throws UsageError.
pybind11::object meshOf(const LevelSetObject& self, double mesh_error, bool outside_only);

}  // namespace stratum::python
