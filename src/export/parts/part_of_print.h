// What a .vdb file says that one of several shards wrote: which part it is, and of what.
#pragma once

#include "base/shard.h"
#include "export/level_set_nodes.h"
#include "voxelize/grid/leaf_stream.h"

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::exporter {

/// Metadata of the grid, with names that begin with "shard_" (and are not in the merged file).
struct PartOfPrint {
    Shard shard;                  ///< "shard_index", "shard_count"
    std::string version;          ///< "shard_version": of the program
    std::string scene;            ///< "shard_scene": hash of the input files and of the options that matter
    voxelize::BlockRange blocks;  ///< "shard_first_block", "shard_end_block"
    /// "shard_leaves", "shard_lower_nodes", "shard_print_upper_nodes": its leaves and lower nodes, whose sums are those
    /// of the print, and the upper nodes of the print
    voxelize::NodeBounds print;
    std::vector<EndSigns> signs;  ///< "shard_signs": of its lower nodes, a digit each
    std::uint32_t checksum = 0;   ///< "shard_checksum": of the bytes of its leaves
};

void insertPart(openvdb::MetaMap& metadata, const PartOfPrint& part);

/// Takes it from the metadata. Throws std::exception if something is missing or impossible.
PartOfPrint takePart(openvdb::MetaMap& metadata);

}  // namespace stratum::exporter
