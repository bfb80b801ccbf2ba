// What the numbers of a mesh mean, for formats that say so.
#pragma once

#include <openvdb/openvdb.h>

namespace stratum::exporter {

/// Unit and axes of a mesh's points.
struct MeshSpace {
    double mm_per_unit = 1.0;  ///< 1, 10 or 1000
    bool up_y = false;         ///< y points up, z forward; else z up

    /// With y up: x stays, so that the handedness does.
    openvdb::Vec3d upY(const openvdb::Vec3d& p) const { return up_y ? p : openvdb::Vec3d(p[0], p[2], -p[1]); }
    /// With z up.
    openvdb::Vec3d upZ(const openvdb::Vec3d& p) const { return up_y ? openvdb::Vec3d(p[0], -p[2], p[1]) : p; }
};

}  // namespace stratum::exporter
