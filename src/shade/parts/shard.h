// Which share of a picture or a film is one process's own.
#pragma once

#include "shade/film/film.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::shade {

/// One of several processes that make something together.
struct Shard {
    int index = 0;  ///< 0 .. count - 1
    int count = 1;
    bool operator==(const Shard&) const = default;
};

/// "I/N", I from 0. Throws UsageError.
Shard parseShard(std::string_view text);

/// What Slurm tells a task of an array, as text; empty where it says nothing.
struct SlurmArray {
    std::string id, least, most, count;  ///< SLURM_ARRAY_TASK_ID, _MIN, _MAX, _COUNT
};

/// The shard ID - MIN of COUNT. Throws UsageError if this is no task of an array, or the array has gaps.
Shard shardOf(const SlurmArray& array);

/// Name of a shard's own file: part.png -> part.2of7.png, with `ending` instead of .png if it is given.
std::filesystem::path shardName(const std::filesystem::path& name, const Shard& shard, std::string_view ending = {});

/// Cuts a region of a picture into `count` rectangles of whole render tiles, row by row, the largest of them as small
/// as rows of such rectangles allow. Throws UsageError if there are fewer tiles.
std::vector<PixelBox> piecesOf(const PixelBox& region, int count);

/// The share of a shard of `count` things in a row: first and end. Throws UsageError if there are fewer than shards.
std::pair<std::size_t, std::size_t> chunkOf(std::size_t count, const Shard& shard);

}  // namespace stratum::shade
