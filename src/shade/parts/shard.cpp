#include "shade/parts/shard.h"

#include "base/error.h"
#include "base/text.h"
#include "shade/integrator/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace stratum::shade {
namespace {

constexpr int kMostShards = 1'000'000;

/// Bands of tile rows, each cut into some of the pieces.
struct Bands {
    std::vector<int> rows;                                            // where each begins, and the end of the last
    std::vector<int> pieces;                                          // the first of each, and the end of the last
    std::int64_t largest = std::numeric_limits<std::int64_t>::max();  // tiles of a piece
};

/// @param by_pieces  rows of a band in proportion to its pieces; else the same for all
Bands bandsOf(int bands, int rows, int columns, int count, bool by_pieces) {
    Bands result;
    for (std::int64_t k = 0; k <= bands; ++k) {
        const auto first = static_cast<int>(count * k / bands);
        result.pieces.push_back(first);
        result.rows.push_back(static_cast<int>(
            by_pieces ? (std::int64_t{rows} * first * 2 + count) / (std::int64_t{2} * count) : rows * k / bands));
    }
    std::int64_t largest = 0;
    for (std::size_t k = 0; k + 1 < result.rows.size(); ++k) {
        const int high = result.rows[k + 1] - result.rows[k];
        const int pieces = result.pieces[k + 1] - result.pieces[k];
        if (high < 1 || pieces > columns) return result;  // some piece would have no tile
        largest = std::max(largest, std::int64_t{high} * ((columns + pieces - 1) / pieces));
    }
    result.largest = largest;
    return result;
}

}  // namespace

Shard parseShard(std::string_view text) {
    const std::size_t slash = text.find('/');
    const auto index = parsed<int>(text.substr(0, slash));
    const auto count = slash == std::string_view::npos ? std::nullopt : parsed<int>(text.substr(slash + 1));
    if (!index || !count)
        throw UsageError(fmt::format(
            "--shard {}: expected I/N, e.g. 0/8 for the first of eight, slurm, or slurm/N in an array", text));
    if (*count < 1 || *count > kMostShards)
        throw UsageError(fmt::format("--shard {}: N must be from 1 to {}", text, kMostShards));
    if (*index < 0 || *index >= *count)
        throw UsageError(fmt::format("--shard {}: I counts from 0, so it must be from 0 to {}", text, *count - 1));
    return {*index, *count};
}

Shard shardOf(const SlurmArray& array) {
    const auto id = parsed<int>(array.id);
    const auto least = parsed<int>(array.least);
    const auto count = parsed<int>(array.count);
    if (!id || !least || !count)
        throw UsageError(
            "--shard slurm: SLURM_ARRAY_TASK_ID, _MIN and _COUNT are not set; run it as a task of an array (sbatch "
            "--array=0-7), or give --shard I/N");
    const auto most = parsed<int>(array.most);
    if (*id < *least || *id - *least >= *count || (most && *most - *least + 1 != *count))
        throw UsageError(fmt::format(
            "--shard slurm: the array of {} tasks from {} has gaps; for some of N shards give --shard slurm/N, for all "
            "use --array=0-{}",
            *count, *least, std::max(*count - 1, 0)));
    return parseShard(fmt::format("{}/{}", *id - *least, *count));
}

std::filesystem::path shardName(const std::filesystem::path& name, const Shard& shard, std::string_view ending) {
    std::filesystem::path own = name;
    const std::string kept = ending.empty() ? name.extension().string() : std::string(ending);
    own.replace_filename(fmt::format("{}.{}of{}{}", name.stem().string(), shard.index, shard.count, kept));
    return own;
}

std::vector<PixelBox> piecesOf(const PixelBox& region, int count) {
    const int left = region.x0 / kTile;
    const int top = region.y0 / kTile;
    const int columns = (region.x1 - 1) / kTile + 1 - left;
    const int rows = (region.y1 - 1) / kTile + 1 - top;
    if (count > std::int64_t{rows} * columns)
        throw UsageError(fmt::format(
            "--shard: {} shards, but the picture has {} tiles of {} x {} pixels; use at most as many shards", count,
            std::int64_t{rows} * columns, kTile, kTile));
    Bands best;
    for (int bands = std::min(rows, count); bands > 0; --bands)
        for (const bool by_pieces : {true, false}) {
            Bands some = bandsOf(bands, rows, columns, count, by_pieces);
            if (some.largest < best.largest) best = std::move(some);
        }
    std::vector<PixelBox> pieces;
    for (std::size_t band = 0; band + 1 < best.rows.size(); ++band) {
        const int across = best.pieces[band + 1] - best.pieces[band];
        for (std::int64_t k = 0; k < across; ++k) {
            const auto column = [&](std::int64_t n) { return left + static_cast<int>(columns * n / across); };
            pieces.push_back(
                {std::max(region.x0, column(k) * kTile), std::max(region.y0, (top + best.rows[band]) * kTile),
                 std::min(region.x1, column(k + 1) * kTile), std::min(region.y1, (top + best.rows[band + 1]) * kTile)});
        }
    }
    return pieces;
}

std::pair<std::size_t, std::size_t> chunkOf(std::size_t count, const Shard& shard) {
    const auto shards = static_cast<std::size_t>(shard.count);
    const auto index = static_cast<std::size_t>(shard.index);
    if (shards > count)
        throw UsageError(fmt::format(
            "--shard: {} shards, but {}; use at most as many shards, or --shard-by tiles to cut each picture", shards,
            count == 1 ? "there is one picture" : fmt::format("the series has {} pictures", count)));
    return {count * index / shards, count * (index + 1) / shards};
}

}  // namespace stratum::shade
