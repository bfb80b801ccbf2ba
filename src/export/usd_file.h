// Writes a .usda beside a .vdb: references to its grids for USD (Houdini Solaris, Omniverse, Karma).
#pragma once

#include "export/mesh/surface_mesh.h"

#include <openvdb/openvdb.h>

#include <filesystem>
#include <vector>

namespace stratum::exporter {

struct UsdOptions {
    double meters_per_unit = 0.001;  ///< of world space
    bool up_y = false;
    /// Of the filaments: a UsdPreviewSurface each, in the scope "materials". A single one is bound to the volume; of
    /// several, which is where is in the grids "tool" and "color".
    std::vector<MeshMaterial> materials = {};
};

/// Writes a UsdVol Volume with an OpenVDBAsset a grid (USD schema UsdVol), which names `vdb` relative to `usda`'s
/// folder; both must be in the same one. Throws OutputError.
void writeUsda(const openvdb::GridPtrVec& grids, const std::filesystem::path& vdb, const std::filesystem::path& usda,
               const UsdOptions& options = {});

}  // namespace stratum::exporter
