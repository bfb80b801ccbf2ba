// Reads the .vdb file of a part.
#pragma once

#include "export/leaf_packer.h"
#include "export/parts/part_of_print.h"
#include "export/vdb_archive.h"

#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::exporter {

/// A part without its leaves.
struct PartFile {
    std::filesystem::path path;
    PartOfPrint part;
    openvdb::FloatGrid::Ptr grid;  ///< name, background, transform, and the metadata that all parts share
    LeafFormat format;
    GridStatistics statistics;
    openvdb::io::DelayedLoadMetadata::Ptr list;  ///< empty if there are no leaves
    std::size_t listed = 0;                      ///< leaves in the list
    GridPlaces places;
};

/// Reads a part and checks all of it but its leaves. Throws InputError for other files and damaged ones.
PartFile readPartFile(const std::filesystem::path& path);

/// Its lower nodes, in their order. Throws InputError unless the list has as many leaves as they.
std::vector<LowerNode> nodesOf(const PartFile& file);

/// What its list says of a leaf.
PackedLeaf leafOf(const PartFile& file, std::size_t n);

/// What to say of a damaged part.
std::string damageOf(const std::filesystem::path& path, std::string_view why);

/// Whether there is such a file, and it is that shard's part of that scene by that version, undamaged.
bool isPartOfPrint(const std::filesystem::path& path, const std::string& version, const std::string& scene,
                   const Shard& shard);

}  // namespace stratum::exporter
