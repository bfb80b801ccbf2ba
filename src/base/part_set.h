// The parts that the shards of one whole wrote: all are there, each once, and of the same whole.
#pragma once

#include "base/error.h"
#include "base/shard.h"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum {

/// Throws InputError with what is wrong with parts, a line each.
[[noreturn]] void refuseParts(std::vector<std::string> problems);

/// Reads the parts and sorts them by number; Found has their `path`. Throws InputError that names each part that is
/// missing, doubled, unreadable or foreign.
/// @param read        of a path: Found; throws InputError
/// @param shard       of a Found
/// @param difference  of a Found and the first one: why they can't be of one whole, "of another scene"; empty if they
///                    can
/// @param remedy      for a missing one, "trace it with"
template <typename Found, typename Read, typename ShardOf, typename Difference>
std::vector<Found> wholeSet(const std::vector<std::filesystem::path>& paths, const Read& read, const ShardOf& shard,
                            const Difference& difference, std::string_view remedy) {
    std::vector<std::string> problems;
    std::vector<Found> found;
    for (const std::filesystem::path& path : paths) {
        try {
            found.push_back(read(path));
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    if (found.empty()) refuseParts(std::move(problems));
    const Found& first = found.front();
    std::vector<Found*> places(static_cast<std::size_t>(shard(first).count));
    for (Found& one : found) {
        const std::string differs = difference(one, first);
        if (!differs.empty()) {
            problems.push_back(
                fmt::format("{}: is {}, compared with {}", one.path.string(), differs, first.path.string()));
            continue;
        }
        Found*& place = places[static_cast<std::size_t>(shard(one).index)];
        if (place)
            problems.push_back(fmt::format("{}: is shard {} of {}, as {} is; name each once", one.path.string(),
                                           shard(one).index, places.size(), place->path.string()));
        else
            place = &one;
    }
    for (std::size_t n = 0; n < places.size(); ++n)
        if (!places[n])
            problems.push_back(
                fmt::format("shard {} of {} is missing; {} --shard {}/{}", n, places.size(), remedy, n, places.size()));
    if (!problems.empty()) refuseParts(std::move(problems));
    std::vector<Found> sorted;
    sorted.reserve(places.size());
    for (Found* place : places) sorted.push_back(std::move(*place));
    return sorted;
}

}  // namespace stratum
