#include "export/nano_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"

#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <exception>
#include <stdexcept>
#include <string>
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

Handle handleOf(const openvdb::GridBase::Ptr& grid, bool half) {
    if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) {
        if (half) return nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp16>(*floats);
        return nanovdb::openToNanoVDB(*floats);
    }
    if (const auto numbers = openvdb::gridPtrCast<openvdb::Int32Grid>(grid)) return nanovdb::openToNanoVDB(*numbers);
    if (const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid)) return nanovdb::openToNanoVDB(*vectors);
    throw std::invalid_argument("writeNano() has no grids of " + grid->valueType());
}

}  // namespace

bool isNanoPath(const std::filesystem::path& path) { return lowerCase(path.extension().string()) == ".nvdb"; }

void writeNano(const openvdb::GridPtrVec& grids, const std::filesystem::path& path, const FileOptions& options) {
    AtomicFile(path).write([&](const std::filesystem::path& to) {
        std::vector<Handle> handles;
        handles.reserve(grids.size());
        for (const openvdb::GridBase::Ptr& grid : grids) handles.push_back(handleOf(grid, options.half));
        try {
            nanovdb::io::writeGrids(to.string(), handles, codecOf(options.compression));
        } catch (const std::exception& error) {
            throw writeError(to.string(), error.what());
        }
    });
}

}  // namespace stratum::exporter
