#include "base/memory.h"

#include "base/error.h"
#include "base/human_text.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

namespace stratum {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

// A file of one number; nothing for "max", or if there is none.
std::optional<std::size_t> numberIn(const fs::path& path) {
    std::ifstream file(path);
    std::size_t number = 0;
    if (file >> number) return number;
    return std::nullopt;
}

// The number behind a key in a file of lines "key number".
std::size_t numberOf(const fs::path& path, const std::string& key) {
    std::ifstream file(path);
    std::string name;
    std::size_t number = 0;
    while (file >> name >> number)
        if (name == key) return number;
    return 0;
}

struct GroupFiles {
    const char* limit;
    const char* usage;
    const char* droppable;  // key in memory.stat
};
constexpr GroupFiles kSecond{"memory.max", "memory.current", "inactive_file"};
constexpr GroupFiles kFirst{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};

// Of a group and all above it, up to `top`.
std::size_t freeAlong(const fs::path& top, const std::string& group, const GroupFiles& files) {
    std::size_t least = kUnlimited;
    fs::path path = fs::path(group).relative_path();
    while (true) {
        const fs::path folder = top / path;
        if (const auto limit = numberIn(folder / files.limit)) {
            const std::size_t usage = numberIn(folder / files.usage).value_or(0);
            const std::size_t used = usage - std::min(usage, numberOf(folder / "memory.stat", files.droppable));
            least = std::min(least, *limit - std::min(*limit, used));
        }
        if (path.empty()) return least;
        path = path.parent_path();
    }
}

std::size_t leftOf(int resource, std::size_t used) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
    return limit.rlim_cur - std::min<std::size_t>(limit.rlim_cur, used);
}

}  // namespace

std::optional<std::size_t> freeInGroups(const fs::path& mounted, const std::string& membership) {
    std::size_t least = kUnlimited;
    std::istringstream lines(membership);
    for (std::string line; std::getline(lines, line);) {
        // hierarchy:controllers:path
        const std::size_t first = line.find(':');
        const std::size_t second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string group = line.substr(second + 1);
        if (second == first + 1) least = std::min(least, freeAlong(mounted, group, kSecond));
        std::istringstream controllers(line.substr(first + 1, second - first - 1));
        for (std::string name; std::getline(controllers, name, ',');)
            if (name == "memory") least = std::min(least, freeAlong(mounted / "memory", group, kFirst));
    }
    // The first version writes a number near 2^63 for "none".
    if (least >= kUnlimited / 4) return std::nullopt;
    return least;
}

std::size_t availableMemory() {
    std::size_t least = std::size_t{4} << 30;  // if the system does not tell
    std::ifstream meminfo("/proc/meminfo");
    std::string key;
    std::string unit;
    std::size_t kilobytes = 0;
    while (meminfo >> key >> kilobytes >> unit)
        if (key == "MemAvailable:") least = kilobytes * 1024;
    std::ifstream self("/proc/self/cgroup");
    const std::string membership{std::istreambuf_iterator<char>(self), {}};
    least = std::min(least, freeInGroups("/sys/fs/cgroup", membership).value_or(kUnlimited));
    // In pages: all, resident, shared, code, none, data.
    std::ifstream statm("/proc/self/statm");
    std::size_t pages[6]{};
    for (std::size_t& count : pages) statm >> count;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    least = std::min({least, leftOf(RLIMIT_AS, pages[0] * page), leftOf(RLIMIT_DATA, pages[5] * page)});
    return least / 10 * 9;
}

void requireMemory(double bytes, std::string_view what, std::string_view advice, std::size_t limit) {
    const auto free = static_cast<double>(limit);
    if (bytes > free)
        throw UsageError(
            fmt::format("{} needs about {}, {} are free; {}", what, humanBytes(bytes), humanBytes(free), advice));
}

}  // namespace stratum
