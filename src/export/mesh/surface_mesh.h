// The zero level of a grid as polygons.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stratum::exporter {

/// Of memory while a surface is meshed, for each leaf of its grid: the copy, points, faces and lists for simplifying;
/// measured.
constexpr double kMeshBytesPerLeaf = 25e3;

/// What a part of the surface is made of.
struct MeshMaterial {
    std::string name;                     ///< of letters, digits and '_': "tool_0", "tool_0_ff8000", "filament"
    std::array<std::uint8_t, 3> color{};  ///< sRGB
};

/// A closed surface: every edge is used by equally many faces in both directions. Points in world units; no face has a
/// point twice, no point is unused. Faces are counter-clockwise from outside.
struct SurfaceMesh {
    /// A quad, or a triangle whose last corner is kNone.
    using Face = std::array<std::uint32_t, 4>;
    static constexpr std::uint32_t kNone = 0xffffffff;

    std::vector<openvdb::Vec3s> points;
    std::vector<Face> faces;
    std::vector<MeshMaterial> materials;           ///< none: nothing is known of them
    std::vector<std::uint32_t> material_of_point;  ///< index into materials; empty: all are of the only one, or of none
    double error = 0;  ///< voxels: the sum of what simplifying was allowed, see mesh_simplify.h

    /// Calls visit(a, b, c) with the indices of each triangle; a quad has two.
    template <typename Visit>
    void forEachTriangle(const Visit& visit) const {
        for (const Face& f : faces) {
            visit(f[0], f[1], f[2]);
            if (f[3] != kNone) visit(f[0], f[2], f[3]);
        }
    }

    /// The material of a face, if there are several: that of most of its points; of equally many, that of the first.
    std::uint32_t materialOf(const Face& face) const;
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
    /// Triangles at most; 0: any number. The allowed error grows until there are no more, or until edges can't be
    /// collapsed without changing how parts hang together.
    std::size_t most_triangles = 0;
    /// Gives the points materials by the nearest active voxel of this grid (linear sRGB), and doesn't simplify faces
    /// between materials; may be null.
    const openvdb::Vec3SGrid* color = nullptr;
    /// T numbers of the same voxels: a material a tool and color, even where tools have the same color; may be null.
    const openvdb::Int32Grid* tool = nullptr;
};

/// Meshes the zero level with OpenVDB's dual mesher (volumeToMesh; Ju et al., SIGGRAPH 2002, is the method). Samples
/// within a thousandth of a voxel of the surface are first moved that far inside: a print's layer planes are on
/// samples, and a sheet of zeros between two solids would become two coincident faces. Where neighbouring cells still
/// get the same point, faces are collapsed; the mesh stays closed. Works on a copy of the grid. Throws UsageError if
/// memory is short.
SurfaceMesh meshSurface(const openvdb::FloatGrid& grid, const MeshOptions& options = {});

}  // namespace stratum::exporter
