#include "export/vdb_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "voxelize/beads/settling.h"

#include <fmt/format.h>

#include <fstream>

namespace stratum::exporter {
namespace {

// openvdb::io::File writes the same bytes, but ignores write errors of its own stream: on a full disk it would leave a
// truncated file without an error.
class CheckedArchive : public openvdb::io::Archive {
public:
    void writeTo(std::ostream& stream, const openvdb::GridPtrVec& grids) const { write(stream, grids, true); }
};

std::string beadModel(const gcode::DepositModel& deposit) {
    std::string text = deposit.stadium()
                           ? "hypot(max(rho - c, 0), z - zc) - h/2, c = (w - h)/2; layers welded"
                           : "d = rho - c, v = |z - zc| - (h/2 - r): hypot(max(d, 0), max(v, 0)) + min(max(d, v), 0) "
                             "- r; layers welded";
    if (deposit.corner_mm)
        text += fmt::format("; r = {:g} mm, at most h/2", *deposit.corner_mm);
    else if (!deposit.stadium())
        text += fmt::format("; r = {:g} h/2", deposit.corner_fraction);
    if (deposit.flow_lag) text += fmt::format("; widths by flow, lag {:g} s", *deposit.flow_lag);
    if (deposit.sag > 0) text += fmt::format("; beads over nothing hang by {:g} of their span", deposit.sag);
    if (deposit.settles()) text += "; settled: overlaps fill grooves";
    return text;
}

}  // namespace

void describe(openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, const Provenance& provenance) {
    const auto text = [&grid](const char* name, const std::string& value) {
        if (!value.empty()) grid.insertMeta(name, openvdb::StringMetadata(value));
    };
    const auto number = [&grid](const char* name, double value) {
        grid.insertMeta(name, openvdb::DoubleMetadata(value));
    };
    grid.setCreator("gcode2vdb " STRATUM_VERSION);
    text("program", "gcode2vdb " STRATUM_VERSION);
    text("source_file", provenance.source_file);
    text("source_sha256", provenance.source_sha256);
    text("slicer", provenance.slicer);
    text("unit", provenance.unit);
    text("up", provenance.up);
    text("snapshot", provenance.snapshot);
    text("selection", provenance.selection);
    text("filament_color", provenance.filament_color);
    text("bead_model", beadModel(provenance.deposit));
    text("interior", provenance.swept ? "distance" : "negative bound, not a distance");
    text("enclosed", provenance.culled ? "filled: only what the outside can reach is there" : "kept");
    if (const auto& part = provenance.part) {
        grid.insertMeta("part_bbox_min", openvdb::Vec3DMetadata(openvdb::Vec3d(part->min)));
        grid.insertMeta("part_bbox_max", openvdb::Vec3DMetadata(openvdb::Vec3d(part->max)));
    }
    number("voxel_size_mm", lattice.voxel_size);
    number("half_width_voxels", lattice.half_width);
    number("layer_height_mm", lattice.layer_height);
    if (provenance.deposit.settles()) number("largest_slope", voxelize::kSettledSlope);
    // The file_* statistics that production loaders look for, e.g. file_mem_bytes.
    grid.addStatsMetadata();
}

void writeVdb(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options) {
    AtomicFile output(path);
    for (const openvdb::GridBase::Ptr& grid : grids) grid->setSaveFloatAsHalf(options.half);
    try {
        CheckedArchive archive;
        std::uint32_t flags = openvdb::io::COMPRESS_NONE;
        // Inactive voxels are not stored: they have the background value.
        if (options.compression == Compression::blosc)
            flags = openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;
        if (options.compression == Compression::zip)
            flags = openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK;
        archive.setCompression(flags);
        std::ofstream stream(output.temporary(), std::ios::binary);
        archive.writeTo(stream, grids);
        stream.close();
        if (!stream) throw OutputError(fmt::format("{}: could not be written; is the disk full?", path.string()));
    } catch (const openvdb::Exception& error) {
        throw OutputError(fmt::format("{}: could not be written ({}); is the disk full?", path.string(), error.what()));
    }
    output.commit();
}

}  // namespace stratum::exporter
