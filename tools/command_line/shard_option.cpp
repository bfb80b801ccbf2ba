#include "shard_option.h"

#include "base/checksum.h"
#include "base/input_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace stratum::tools {
namespace {

std::string environment(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread
    return value ? value : "";
}

}  // namespace

Shard givenShard(const std::string& text) {
    constexpr std::string_view kSlurm = "slurm";
    const std::string_view count = std::string_view(text).substr(std::min(kSlurm.size(), text.size()));
    if (!text.starts_with(kSlurm) || (!count.empty() && count.front() != '/')) return parseShard(text);
    if (!count.empty()) return parseShard(environment("SLURM_ARRAY_TASK_ID") + std::string(count));
    return shardOf({environment("SLURM_ARRAY_TASK_ID"), environment("SLURM_ARRAY_TASK_MIN"),
                    environment("SLURM_ARRAY_TASK_MAX"), environment("SLURM_ARRAY_TASK_COUNT")});
}

std::string saidOf(const CLI::App& app) {
    // Where the output goes, what is reported, on how many threads and machines changes nothing of it.
    constexpr std::array<std::string_view, 12> kOther = {"output",   "film",   "checkpoint", "threads",
                                                         "stats",    "quiet",  "IN",         "shard",
                                                         "shard-by", "resume", "summary",    "force"};
    std::string said;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_single_name();
        if (option->count() == 0 || std::find(kOther.begin(), kOther.end(), name) != kOther.end()) continue;
        said += fmt::format("{} {}\n", name, fmt::join(option->results(), " "));
    }
    return said;
}

std::string contentHash(const std::string& path) {
    std::error_code missing;
    if (!std::filesystem::is_regular_file(path, missing)) return {};
    return sha256Hex(InputFile(path).bytes());
}

}  // namespace stratum::tools
