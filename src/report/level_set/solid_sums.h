// Integrals over a level set, cell by cell: volume and its moments, pores, surface.
#pragma once

#include "report/level_set/leaf_map.h"
#include "report/level_set/outside.h"

#include <cstddef>
#include <vector>

namespace stratum::report {

/// One row of cells, between sample planes k and k + 1; in cells.
struct RowSums {
    double solid = 0;
    double open = 0, closed = 0;  ///< pores
};

/// In units of the voxel, about the sample of index (0, 0, 0).
struct SolidSums {
    int first_row = 0;
    std::vector<RowSums> rows;
    double volume = 0;
    double first[3] = {};   ///< integrals of x, y, z
    double second[6] = {};  ///< of xx, yy, zz, xy, xz, yz
    /// Of the surface that the outside reaches, of what reaches pores, and how many leaves they were measured in.
    double outer_area = 0, inner_area = 0;
    std::size_t area_leaves = 0;
};

/// The surface is measured in all leaves if they are fewer, else in a sample of about so many, chosen by a hash of
/// their number. On a print of 1.4 times as many leaves it was 0.08 % (outer) and 0.23 % (inner) off.
constexpr std::size_t kAreaSample = std::size_t{1} << 17;

/// Of what is solid. A cell of eight negative samples is; a mixed one is measured along four
/// lines along z, as in voxelize/grid/solid_check.h, but without what interpolation adds (interpolation_bias.h). Its
/// air belongs to the kinds of its corners that are not plastic, in equal parts. `background` of the grid, positive,
/// and `voxel`, its edge, in the unit of the samples. Without `outside` (of a culled grid nothing can be told of
/// pores), all surface is outer and no pore is counted. Parallel; the same sums for any number of threads.
SolidSums sumSolid(const LeafMap& map, float background, double voxel, const Outside* outside);

}  // namespace stratum::report
