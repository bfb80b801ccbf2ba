// The memory available to this process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace stratum {

/// 90 % of the available memory, bytes: the least of the machine's free memory, the remaining memory of this process's
/// control groups (cgroup v1 and v2, and their parents), and of its limits on address space and data (ulimit -v, -d).
/// Linux; reads files, so call it once and keep the result.
std::size_t availableMemory();

/// The remaining memory of the memory groups, bytes; nothing if none sets a limit. `mounted` is their folder,
/// /sys/fs/cgroup; `membership` the text of /proc/self/cgroup. File pages that can be dropped count as free. In a
/// container the groups may not be visible by their full names: then those at the top of `mounted` are used.
std::optional<std::size_t> freeInGroups(const std::filesystem::path& mounted, const std::string& membership);

}  // namespace stratum
