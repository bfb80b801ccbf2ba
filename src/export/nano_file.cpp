#include "export/nano_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/own_file.h"
#include "base/text.h"

#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)  // from OpenVDB 12 on
#define NANOVDB_USE_OPENVDB
#include <nanovdb/io/IO.h>
#include <nanovdb/tools/CreateNanoGrid.h>
#else
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

#include <exception>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace stratum::exporter {
namespace {

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

nanovdb::io::Codec codecOf(Compression compression) {
    switch (compression) {
        case Compression::blosc:
            return nanovdb::io::Codec::BLOSC;
        case Compression::zip:
            return nanovdb::io::Codec::ZIP;
        case Compression::none:
            break;
    }
    return nanovdb::io::Codec::NONE;
}

#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
template <typename Grid>
Handle nanoOf(const Grid& grid) {
    return nanovdb::tools::createNanoGrid(grid);
}
Handle halfNanoOf(const openvdb::FloatGrid& grid) {
    return nanovdb::tools::createNanoGrid<openvdb::FloatGrid, nanovdb::Fp16>(grid);
}
#else
template <typename Grid>
Handle nanoOf(const Grid& grid) {
    return nanovdb::openToNanoVDB(grid);
}
Handle halfNanoOf(const openvdb::FloatGrid& grid) {
    return nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp16>(grid);
}
#endif

Handle handleOf(const openvdb::GridBase::Ptr& grid, bool half) {
    if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
        return half ? halfNanoOf(*floats) : nanoOf(*floats);
    if (const auto numbers = openvdb::gridPtrCast<openvdb::Int32Grid>(grid)) return nanoOf(*numbers);
    if (const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid)) return nanoOf(*vectors);
    throw std::invalid_argument("writeNano() has no grids of " + grid->valueType());
}

}  // namespace

bool isNanoPath(const std::filesystem::path& path) { return lowerCase(path.extension().string()) == ".nvdb"; }

void writeNano(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options) {
    double bytes = 0;
    for (const openvdb::GridBase::Ptr& grid : grids) bytes += static_cast<double>(grid->memUsage());
    requireMemory(kNanoCopies * bytes, path.string(), "choose a larger voxel, fewer grids or a .vdb");
    AtomicFile(path).write([&](const std::filesystem::path& to) {
        std::vector<Handle> handles;
        handles.reserve(grids.size());
        for (const openvdb::GridBase::Ptr& grid : grids) handles.push_back(handleOf(grid, options.half));
        try {
            nanovdb::io::writeGrids(to.string(), handles, codecOf(options.compression));
        } catch (const std::exception& error) {
            throw writeError(to.string(), error.what());
        }
        // The format has no room for a mark. Its readers take less than the 16 bytes of a segment's header for the end.
        constexpr std::string_view kMark = kProgramMark;
        static_assert(kMark.size() < 16);
        std::ofstream file(to, std::ios::binary | std::ios::app);
        file << kMark;
        file.close();
        if (!file) throw writeError(to.string());
    });
}

}  // namespace stratum::exporter
