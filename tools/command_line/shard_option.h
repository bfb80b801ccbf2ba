// --shard as it is given, and what a shard says that its part is of.
#pragma once

#include "base/shard.h"

#include <CLI/CLI.hpp>

#include <string>

namespace stratum::tools {

/// "I/N", or "slurm": a task of an array, which says so in its environment; or "slurm/N": its number is that of the
/// task, of N, so that an array of some numbers makes some of the shards. Throws UsageError.
Shard givenShard(const std::string& text);

/// The options that were given and may change what is made, as text for hashes: the same for any order of them.
std::string saidOf(const CLI::App& app);

/// A hash of a file's contents; empty for what is no file: a preset, whose name is among the options.
std::string contentHash(const std::string& path);

}  // namespace stratum::tools
