// FloatGrid -> .vdb with metadata about the grid and its origin; written whole or not at all.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::exporter {

/// The origin of a grid, written as grid metadata with the names given here.
struct Provenance {
    std::string source_file;     ///< "source_file": name without folders
    std::string source_sha256;   ///< "source_sha256"
    std::string slicer;          ///< "slicer", left out if empty
    std::string unit = "mm";     ///< "unit": of world space
    std::string up = "z";        ///< "up": axis of world space that points away from the bed, z or y
    std::string snapshot;        ///< "snapshot": label of a partial print, left out if empty
    std::string filament_color;  ///< "filament_color": "#RRGGBB", sRGB, if all beads have one and it is stated
    std::string selection;       ///< "selection": --layers and --features, left out if empty
    /// "part_bbox_min", "part_bbox_max", Vec3d: the part's box in world space, without skirts and towers; see
    /// partBounds(). Left out if empty.
    std::optional<voxelize::Bounds> part;
    /// "part_outline", text: points around the part, "x y z x y z ..."; see partOutline(). Left out if empty.
    std::vector<std::array<double, 3>> outline;
    gcode::DepositModel deposit;  ///< "bead_model": the formula of the field
    bool culled = false;          ///< "enclosed": whether enclosed surfaces have been removed
    bool swept = false;           ///< "interior": whether negative values are distances
};

enum class Compression : std::uint8_t { blosc, zip, none };

struct FileOptions {
    bool half = false;  ///< 16-bit floats: half the file, values good to 2^-11 of the band
    Compression compression = Compression::blosc;
};

/// Adds the metadata: provenance, "voxel_size_mm", "half_width_voxels", "layer_height_mm", "bead_model", "interior",
/// "largest_slope" where values change faster than distance, "program", creator, and OpenVDB's own file statistics.
void describe(openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, const Provenance& provenance);

/// openvdb::io::COMPRESS_*. Inactive voxels are not stored: they have the background value.
std::uint32_t compressionFlags(Compression compression);

/// Writes the grids to `path`, in the given order, each with OpenVDB's file statistics. Leaves are packed on all
/// threads; OpenVDB reads the same grids as from a file of its own writer. Grids of numbers and vectors; no names
/// twice. Throws OutputError; the old file then stays.
void writeVdb(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options = {});

}  // namespace stratum::exporter
