// Area of the surface in one cell of a level set, as polygons between the crossings of its edges.
//
// Where the field changes sign along an edge of the cell, the surface crosses it; linear interpolation finds the place.
// On each face the crossings are joined in pairs, so that corners inside are parted from each other where that is open
// to choice; both cells of a face then join the same pairs. The segments form closed polygons. The 256 cases are worked
// out once, from the faces. Source of the idea: Lorensen and Cline, Marching Cubes, SIGGRAPH 87.
#pragma once

#include <array>
#include <cstdint>

namespace stratum::report {

/// Polygons of one case of signs: edges in order, each polygon after its length; ends with 0.
struct CellPolygons {
    std::array<std::uint8_t, 20> edges{};
};

/// By the signs of the corners: bit n is set if corner n is inside (negative); corner n is at x = n & 1, y = n >> 1 &
/// 1, z = n >> 2.
const std::array<CellPolygons, 256>& cellPolygons();

/// In units of the cell's edge squared. `corners` as above; not all of one sign.
double cellSurface(const float (&corners)[8]);

}  // namespace stratum::report
