// The zero level of a grid as polygons.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::exporter {

/// A closed surface: every edge is used by equally many faces in both directions. Points in world units; no face has a
/// point twice, no point is unused. Faces are counter-clockwise from outside.
struct SurfaceMesh {
    /// A quad, or a triangle whose last corner is kNone.
    using Face = std::array<std::uint32_t, 4>;
    static constexpr std::uint32_t kNone = 0xffffffff;

    std::vector<openvdb::Vec3s> points;
    std::vector<Face> faces;
    std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB, one a point; or none

    /// Calls visit(a, b, c) with the indices of each triangle; a quad has two.
    template <typename Visit>
    void forEachTriangle(const Visit& visit) const {
        for (const Face& f : faces) {
            visit(f[0], f[1], f[2]);
            if (f[3] != kNone) visit(f[0], f[2], f[3]);
        }
    }

    /// A quad counts as two.
    std::size_t triangleCount() const;
    /// Enclosed volume, world units cubed.
    double volume() const;
};

struct MeshOptions {
    /// Leaves out the surfaces of cavities: parts of the mesh that enclose a negative volume.
    bool outside_only = false;
    /// Voxels: allowed error of the simplified mesh, see mesh_simplify.h; 0 keeps a point in every surface cell.
    double error = 0.0;
    /// Colors the points by the nearest active voxel of this grid (linear sRGB), and doesn't simplify faces between
    /// colors; may be null.
    const openvdb::Vec3SGrid* color = nullptr;
};

/// Meshes the zero level with OpenVDB's dual mesher (volumeToMesh; Ju et al., SIGGRAPH 2002, is the method). Samples
/// within a thousandth of a voxel of the surface are first moved that far inside: a print's layer planes are on
/// samples, and a sheet of zeros between two solids would become two coincident faces. Where neighbouring cells still
/// get the same point, faces are collapsed; the mesh stays closed. Works on a copy of the grid.
SurfaceMesh meshSurface(const openvdb::FloatGrid& grid, const MeshOptions& options = {});

}  // namespace stratum::exporter
