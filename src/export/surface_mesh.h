// The zero level of a grid as polygons.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::exporter {

/// A closed surface: every edge of a face is met by as many faces one way as the other. Points in world units; no face
/// has a point twice, no point is unused. Faces are counter-clockwise from outside.
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
    /// Voxels: how far the simplified mesh may lie from the full one; 0 keeps a point in every surface cell. See
    /// mesh_simplify.h for what that bounds.
    double error = 0.0;
    /// Colors the points by the nearest active voxel of this grid (linear sRGB), and keeps the faces between colors as
    /// they are; may be null.
    const openvdb::Vec3SGrid* color = nullptr;
};

/// Meshes the zero level with OpenVDB's dual mesher (volumeToMesh; Ju et al., SIGGRAPH 2002, is the method). Samples
/// within a thousandth of a voxel of the surface are first put that far inside: a print's layer planes lie on samples,
/// and a sheet of zeros between two solids would become two faces in one place. Where neighbouring cells still get the
/// same point, faces are collapsed, which opens nothing. Works on a copy of the grid.
SurfaceMesh meshSurface(const openvdb::FloatGrid& grid, const MeshOptions& options = {});

}  // namespace stratum::exporter
