#include "base/shard.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace stratum {
namespace {

constexpr int kMostShards = 1'000'000;

std::optional<int> numberOf(std::string_view text) {
    int value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

Shard parseShard(std::string_view text) {
    const std::size_t slash = text.find('/');
    const auto index = numberOf(text.substr(0, slash));
    const auto count = slash == std::string_view::npos ? std::nullopt : numberOf(text.substr(slash + 1));
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
    const auto id = numberOf(array.id);
    const auto least = numberOf(array.least);
    const auto count = numberOf(array.count);
    if (!id || !least || !count)
        throw UsageError(
            "--shard slurm: SLURM_ARRAY_TASK_ID, _MIN and _COUNT are not set; run it as a task of an array (sbatch "
            "--array=0-7), or give --shard I/N");
    const auto most = numberOf(array.most);
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

}  // namespace stratum
