// Writes a .usda beside a .vdb: references to its grids for USD (Houdini Solaris, Omniverse, Karma).
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>

namespace stratum::exporter {

struct UsdOptions {
    double meters_per_unit = 0.001;  ///< of world space
    bool up_y = false;
};

/// Writes a UsdVol Volume with an OpenVDBAsset a grid (USD schema UsdVol), which names `vdb` relative to `usda`'s
/// folder; both must be in the same one. Throws OutputError.
void writeUsda(const openvdb::GridPtrVec& grids, const std::filesystem::path& vdb, const std::filesystem::path& usda,
               const UsdOptions& options = {});

}  // namespace stratum::exporter
