#include "export/vdb_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "export/vdb_archive.h"
#include "voxelize/beads/part_outline.h"
#include "voxelize/beads/settling.h"

#include <fmt/format.h>
#include <openvdb/io/io.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

namespace stratum::exporter {
namespace {

// Types of which OpenVDB lists the leaves.
using WritableGrids = openvdb::TypeList<openvdb::Int32Grid, openvdb::Int64Grid, openvdb::FloatGrid, openvdb::DoubleGrid,
                                        openvdb::Vec3IGrid, openvdb::Vec3SGrid, openvdb::Vec3DGrid>;

constexpr std::size_t kPackedAtOnce = 8192;  // leaves, about 10 MB
constexpr std::size_t kPackedByOne = 64;

// Writes the leaves of a tree from places.leaves on; sets places.end. One batch is packed while the one before is
// written.
template <typename TreeType>
void writeLeaves(const TreeType& tree, const LeafFormat& format, PositionedFile& file, GridPlaces& places,
                 LeafList& list) {
    const openvdb::tree::LeafManager<const TreeType> leaves(tree);
    struct Part {
        std::vector<char> bytes;
        std::vector<PackedLeaf> leaves;
    };
    std::vector<Part> packing(kPackedAtOnce / kPackedByOne);
    std::vector<Part> writing(packing.size());
    places.end = places.leaves;
    const auto write = [&] {
        const std::uint64_t from = places.end;
        std::vector<iovec> bytes;
        for (Part& part : writing) {
            if (!part.bytes.empty()) bytes.push_back({part.bytes.data(), part.bytes.size()});
            places.end += part.bytes.size();
            for (const PackedLeaf leaf : part.leaves) list.add(leaf);
        }
        file.write(from, bytes);
        file.startFlush(from, places.end);
    };
    const auto background = tree.background();
    list.reserve(leaves.leafCount());
    for (std::size_t batch = 0; batch < leaves.leafCount(); batch += kPackedAtOnce) {
        parallelFor(packing.size() + 1, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n < last; ++n) {
                if (n == 0) {
                    write();
                    continue;
                }
                Part& part = packing[n - 1];
                part.bytes.clear();
                part.leaves.clear();
                PackingStream stream(format, &background, part.bytes);
                const std::size_t end = std::min(batch + n * kPackedByOne, leaves.leafCount());
                for (std::size_t k = batch + (n - 1) * kPackedByOne; k < end; ++k) {
                    const std::size_t begin = part.bytes.size();
                    if constexpr (std::is_same_v<TreeType, openvdb::FloatTree>) {
                        const float* values = leaves.leaf(k).buffer().data();
                        const LeafMask& active = leaves.leaf(k).valueMask();
                        if (isClamped(values, active, background)) {
                            part.leaves.push_back(packClampedLeaf(format, values, active, background, part.bytes));
                            continue;
                        }
                    }
                    leaves.leaf(k).writeBuffers(stream, format.half);
                    part.leaves.push_back(leafWritten(format, part.bytes, begin, sizeof(typename TreeType::ValueType)));
                }
            }
        });
        std::swap(packing, writing);
    }
    write();
}

// Writes a grid from `at` on, and returns where it ends.
std::uint64_t writeGrid(const VdbArchive& archive, openvdb::GridBase& grid, PositionedFile& file, std::uint64_t at,
                        std::string& identity) {
    const LeafFormat format = archive.formatOf(grid);
    const auto described = grid.copyGrid();        // shares the tree
    described->setTransform(grid.transformPtr());  // copies of transforms are simplified
    insertStatistics(*described,
                     {.active_box = grid.evalActiveVoxelBoundingBox(),
                      .active_voxels = grid.activeVoxelCount(),
                      .memory_bytes = grid.memUsage()},
                     format);
    GridPlaces places;
    places.head = at;
    LeafList list(format);
    const bool known = grid.apply<WritableGrids>([&](const auto& typed) {
        const auto& tree = typed.constTree();
        places.topology =
            places.head + headBytes(archive, *described, grid.getName(), LeafList::mostBytes(tree.leafCount()));
        PositionedStream topology(file, places.topology);
        openvdb::io::setDataCompression(topology, format.compression);
        tree.writeTopology(topology, format.half);
        topology.writeOut();
        places.leaves = topology.at();
        writeLeaves(tree, format, file, places, list);
    });
    if (!known)
        throw OutputError(
            fmt::format("the grid {} has values of a type ({}) that can't be written; numbers and vectors can",
                        grid.getName(), grid.valueType()));
    const std::string listed = list.bytes();
    writeHead(file, archive, *described, grid.getName(), places, listed);
    identity += identityOf(*described, listed);
    return places.end;
}

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
    if (deposit.strings) text += "; strings on travels through air";
    if (deposit.sag > 0) text += fmt::format("; beads over nothing hang by {:g} of their span", deposit.sag);
    if (deposit.settles()) text += "; settled: overlaps fill grooves";
    if (deposit.swells()) text += ", the rest moves outlines out and tops up";
    if (deposit.swells() && deposit.crown > 0) text += fmt::format("; crowns of {:g} h", deposit.crown);
    return text;
}

}  // namespace

void describe(openvdb::FloatGrid& grid, const voxelize::Lattice& lattice, const Provenance& provenance) {
    const auto text = [&grid](const char* name, const std::string& value) {
        // A series describes one grid for each of its files.
        grid.removeMeta(name);
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
    text("part_outline", voxelize::textOf(provenance.outline));
    number("voxel_size_mm", lattice.voxel_size);
    number("half_width_voxels", lattice.half_width);
    number("layer_height_mm", lattice.layer_height);
    if (provenance.deposit.settles()) number("largest_slope", voxelize::kSettledSlope);
}

std::uint32_t compressionFlags(Compression compression) {
    if (compression == Compression::blosc) return openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;
    if (compression == Compression::zip) return openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK;
    return openvdb::io::COMPRESS_NONE;
}

void writeVdb(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options) {
    AtomicFile output(path);
    const VdbArchive archive(compressionFlags(options.compression));
    PositionedFile file(output.temporary(), path);
    std::string identity;
    std::uint64_t at = archive.header(grids.size(), identity).size();
    for (const openvdb::GridBase::Ptr& grid : grids) {
        grid->setSaveFloatAsHalf(options.half);
        at = writeGrid(archive, *grid, file, at, identity);
    }
    file.write(0, archive.header(grids.size(), identity));
    file.finish(at);
    output.commit();
}

}  // namespace stratum::exporter
