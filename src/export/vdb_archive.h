// The parts of a .vdb file around the trees of its grids, in the format of OpenVDB 10 (224), as io::Archive writes
// them.
//
// A file begins with a header. Each grid has a head (descriptor, metadata, transform), the topology of its tree, and
// the values of its leaves. The metadata hold a list of the leaves' sizes (io::DelayedLoadMetadata), which is known
// last; so a head is given room before the leaves and written after them. What of that room is not used lies at the end
// of the list, where every OpenVDB since 6.2 skips what it does not know, and is a hole in the file of at most a
// hundredth.
#pragma once

#include "export/leaf_packer.h"
#include "export/positioned_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::exporter {

class VdbArchive : public openvdb::io::Archive {
public:
    /// `compression`: openvdb::io::COMPRESS_*.
    explicit VdbArchive(std::uint32_t compression) { setCompression(compression); }

    /// The header of a file with this many grids. `identity` makes the file's UUID: the same contents, the same bytes.
    std::string header(std::size_t grids, const std::string& identity) const;
    /// Of the values of this grid, which OpenVDB decides by its class.
    LeafFormat formatOf(const openvdb::GridBase& grid) const;
};

/// io::DelayedLoadMetadata of all leaves, in the file's order.
class LeafList {
public:
    explicit LeafList(const LeafFormat& format) : format_(format) {}
    void reserve(std::size_t leaves);
    void add(PackedLeaf leaf);
    std::size_t leaves() const { return kinds_.size(); }
    /// As metadata.
    std::string bytes() const;
    /// No list of so many leaves is longer.
    static std::size_t mostBytes(std::size_t leaves);

private:
    LeafFormat format_;
    std::vector<std::int8_t> kinds_;
    std::vector<std::uint16_t> sizes_;
};

/// Places of a grid in its file, bytes.
struct GridPlaces {
    std::uint64_t head = 0;      ///< its descriptor
    std::uint64_t topology = 0;  ///< the first byte after the head
    std::uint64_t leaves = 0;
    std::uint64_t end = 0;
};

/// The bytes of a head with a leaf list of that many bytes.
std::size_t headBytes(const VdbArchive& archive, const openvdb::GridBase& grid, const std::string& name,
                      std::size_t list_bytes);

/// Writes a head between its places; it must fit. `list`: of LeafList::bytes().
void writeHead(PositionedFile& file, const VdbArchive& archive, const openvdb::GridBase& grid, const std::string& name,
               const GridPlaces& places, std::string_view list);

/// What distinguishes a grid's file from others, for VdbArchive::header(). `list`: of LeafList::bytes().
std::string identityOf(const openvdb::GridBase& grid, std::string_view list);

/// The metadata that production loaders look for: file_voxel_count and the others of GridBase::addStatsMetadata(), and
/// file_compression.
struct GridStatistics {
    openvdb::CoordBBox active_box;
    std::size_t active_voxels = 0;
    std::size_t memory_bytes = 0;
};
void insertStatistics(openvdb::GridBase& grid, const GridStatistics& statistics, const LeafFormat& format);

}  // namespace stratum::exporter
