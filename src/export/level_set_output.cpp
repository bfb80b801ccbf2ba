#include "export/level_set_output.h"

#include "base/checksum.h"
#include "base/input_file.h"
#include "export/parts/checksum.h"

#include <openvdb/io/io.h>

#include <string_view>
#include <utility>

namespace stratum::exporter {

LevelSetOutput::LevelSetOutput(openvdb::FloatGrid::Ptr grid, const std::filesystem::path& path,
                               std::uint32_t compression, const voxelize::NodeBounds& bounds,
                               std::optional<PartOfPrint> part)
    : output_(path),
      file_(output_.temporary(), path),
      archive_(compression),
      grid_(std::move(grid)),
      format_(archive_.formatOf(*grid_)),
      part_(std::move(part)),
      list_(format_) {
    // Statistics have their final size already, and what is said of a part its largest.
    insertStatistics(*grid_, {}, format_);
    if (part_) {
        PartOfPrint most = *part_;
        most.signs.resize(bounds.lower_nodes);
        insertPart(*grid_, most);
    }
    places_.head = archive_.header(1, {}).size();
    places_.leaves = places_.head + headBytes(archive_, *grid_, grid_->getName(), LeafList::mostBytes(bounds.leaves)) +
                     LevelSetNodes::mostBytes(format_, bounds.leaves, bounds.lower_nodes, bounds.upper_nodes);
    places_.end = places_.leaves;
}

void LevelSetOutput::add(LowerNode&& node) {
    if (part_) part_->signs.push_back(node.ends);
    nodes_.add(std::move(node));
}

void LevelSetOutput::append(std::span<iovec> leaves) {
    std::uint64_t bytes = 0;
    for (const iovec& piece : leaves) {
        bytes += piece.iov_len;
        if (part_)
            part_->checksum = checksumOf({static_cast<const char*>(piece.iov_base), piece.iov_len}, part_->checksum);
    }
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
    if (part_) insertPart(*grid_, *part_);
    const float background = grid_->background();
    // Without leaves there is no list to take the room that is left.
    if (list_.leaves() == 0)
        places_.leaves = places_.end =
            places_.head + headBytes(archive_, *grid_, grid_->getName(), 0) + nodes_.writtenBytes(format_, background);
    // The topology ends where the leaves begin, so its length is needed first; that of the masks is known.
    places_.topology = places_.leaves - nodes_.writtenBytes(format_, background);
    PositionedStream topology(file_, places_.topology);
    openvdb::io::setDataCompression(topology, format_.compression);
    nodes_.write(topology, background, format_.half);
    topology.writeOut();
    const std::string listed = list_.bytes();
    writeHead(file_, archive_, *grid_, grid_->getName(), places_, listed);
    file_.write(0, archive_.header(1, identity(listed)));
    file_.finish(places_.end);
    output_.commit();
    return {statistics_, nodes_.leafCount()};
}

// That of a part is a checksum of all that stands before its leaves.
std::string LevelSetOutput::identity(std::string_view listed) const {
    if (!part_) return identityOf(*grid_, listed);
    const InputFile written(output_.temporary());
    return identityOfPart(written.bytes().substr(places_.head, places_.leaves - places_.head));
}

}  // namespace stratum::exporter
