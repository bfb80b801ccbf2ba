// How much memory this process may still take.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace stratum {

/// 90 % of what is left, bytes: the least of the machine's free memory, what the control groups of this process (cgroup
/// v1 and v2, and those above) leave it, and what its limits on address space and data (ulimit -v, -d) do. Linux; reads
/// files, so ask once and keep the answer.
std::size_t availableMemory();

/// What the memory groups leave, bytes; nothing if none sets a limit. `mounted` is where they lie, /sys/fs/cgroup;
/// `membership` the text of /proc/self/cgroup. File pages that can be dropped count as free. A container may not see
/// its groups by their full names: then those at the top of `mounted` count.
std::optional<std::size_t> freeInGroups(const std::filesystem::path& mounted, const std::string& membership);

}  // namespace stratum
