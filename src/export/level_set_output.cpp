#include "export/level_set_output.h"

#include <openvdb/io/io.h>

#include <string_view>
#include <utility>

namespace stratum::exporter {
namespace {

// One part in so many of a file may be room that is left; of more the leaves are moved, which then are few.
constexpr std::uint64_t kMostSpare = 100;

}  // namespace

LevelSetOutput::LevelSetOutput(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path,
                               std::uint32_t compression, const voxelize::NodeBounds& bounds)
    : output_(path),
      file_(output_.temporary(), path),
      archive_(compression),
      grid_(std::move(grid)),
      format_(archive_.formatOf(*grid_)),
      list_(format_) {
    // Statistics have their final size already.
    insertStatistics(*grid_, {}, format_);
    places_.head = archive_.header(1, {}).size();
    places_.leaves = places_.head + headBytes(archive_, *grid_, grid_->getName(), LeafList::mostBytes(bounds.leaves)) +
                     LevelSetNodes::mostBytes(format_, bounds.leaves, bounds.lower_nodes, bounds.upper_nodes);
    places_.end = places_.leaves;
}

void LevelSetOutput::append(std::span<iovec> leaves) {
    std::uint64_t bytes = 0;
    for (const iovec& piece : leaves) bytes += piece.iov_len;
    file_.write(places_.end, leaves);
    file_.startFlush(places_.end, places_.end + bytes);
    places_.end += bytes;
}

void LevelSetOutput::count(std::size_t active_voxels, const openvdb::CoordBBox& active_box) {
    statistics_.active_voxels += active_voxels;
    statistics_.active_box.expand(active_box);
}

WrittenGrid LevelSetOutput::finish() {
    nodes_.flood();
    statistics_.memory_bytes = nodes_.memoryBytes();
    insertStatistics(*grid_, statistics_, format_);
    const float background = grid_->background();
    const std::string listed = list_.bytes();
    const std::uint64_t nodes = nodes_.writtenBytes(format_, background);
    const std::uint64_t needed = headBytes(archive_, *grid_, grid_->getName(), listed.size()) + nodes;
    // Without leaves there is no list to take the room that is left.
    const std::uint64_t spare = places_.leaves - places_.head - needed;
    if (listed.empty() || kMostSpare * spare > places_.end - spare) {
        file_.moveForward(places_.leaves, places_.end, spare);
        places_.leaves -= spare;
        places_.end -= spare;
    }
    // The topology ends where the leaves begin.
    places_.topology = places_.leaves - nodes;
    PositionedStream topology(file_, places_.topology);
    openvdb::io::setDataCompression(topology, format_.compression);
    nodes_.write(topology, background, format_.half);
    topology.writeOut();
    writeHead(file_, archive_, *grid_, grid_->getName(), places_, listed);
    file_.write(0, archive_.header(1, identityOf(*grid_, listed)));
    file_.finish(places_.end);
    output_.commit();
    return {statistics_, nodes_.leafCount()};
}

}  // namespace stratum::exporter
