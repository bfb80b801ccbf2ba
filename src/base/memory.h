// The memory available to this process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace stratum {

/// 90 % of the available memory, bytes: the least of the machine's free memory, the remaining memory of this process's
/// control groups (cgroup v1 and v2, and their parents), and of its limits on address space and data (ulimit -v, -d).
/// Linux; reads files, so call it once and keep the result.
std::size_t availableMemory();

/// Throws UsageError if `bytes` are more than `limit`: "`what` needs about 4.4 GB, 3.1 GB are free; `advice`". For work
/// in libraries that end the process, or forget what they hold, where an allocation fails.
void requireMemory(double bytes, std::string_view what, std::string_view advice, std::size_t limit = availableMemory());

/// The remaining memory of the memory groups, bytes; nothing if none sets a limit. `mounted` is their folder,
/// /sys/fs/cgroup; `membership` the text of /proc/self/cgroup. File pages that can be dropped count as free. In a
/// container the groups may not be visible by their full names: then those at the top of `mounted` are used.
std::optional<std::size_t> freeInGroups(const std::filesystem::path& mounted, const std::string& membership);

}  // namespace stratum
