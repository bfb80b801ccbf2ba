#include "base/part_set.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace stratum {
namespace {

constexpr std::size_t kMostNamed = 20;  // of problems, so that a message stays readable

}  // namespace

void refuseParts(std::vector<std::string> problems) {
    const std::size_t more = problems.size() - std::min(problems.size(), kMostNamed);
    problems.resize(problems.size() - more);
    if (more > 0) problems.push_back(fmt::format("and {} more", more));
    throw InputError(fmt::format("{}\nnothing is written", fmt::join(problems, "\n")));
}

}  // namespace stratum
