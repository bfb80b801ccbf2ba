// Grids -> .nvdb: NanoVDB, which programs read into the memory of a GPU as it is.
#pragma once

#include "export/vdb_file.h"

#include <openvdb/openvdb.h>

#include <filesystem>

namespace stratum::exporter {

/// Of the grids' memory while they are written: once more in NanoVDB's form, and packed; measured.
constexpr double kNanoCopies = 1.3;

/// Whether the name ends in .nvdb, in any case.
bool isNanoPath(const std::filesystem::path& path);

/// Writes grids of floats, Int32 and Vec3s, in the given order, with statistics and checksums of their nodes. With
/// FileOptions::half floats are Fp16: 16 bits between the least and the largest value of each 8^3 leaf. NanoVDB keeps
/// names, classes and transforms, but none of the other metadata. The same bytes for any number of threads. Throws
/// UsageError if memory is short, OutputError; the old file then stays.
void writeNano(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options = {});

}  // namespace stratum::exporter
