// Which share of a picture or a film is one process's own.
#pragma once

#include "base/shard.h"
#include "shade/film/film.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace stratum::shade {

/// Cuts a region of a picture into `count` rectangles of whole render tiles, row by row, the largest of them as small
/// as rows of such rectangles allow. Throws UsageError if there are fewer tiles.
std::vector<PixelBox> piecesOf(const PixelBox& region, int count);

/// The share of a shard of `count` things in a row: first and end. Throws UsageError if there are fewer than shards.
std::pair<std::size_t, std::size_t> chunkOf(std::size_t count, const Shard& shard);

}  // namespace stratum::shade
