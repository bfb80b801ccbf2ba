// Work that is divided among processes: what is no part of a whole is refused.
#include "base/error.h"
#include "shade/parts/shard.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace stratum::study {

std::vector<StabilityCase> shardCases() {
    std::vector<StabilityCase> cases;
    const std::vector<std::pair<const char*, const char*>> texts{
        {"no text", ""},
        {"a number alone", "1"},
        {"a part beyond the last", "3/3"},
        {"a part before the first", "-1/2"},
        {"of nothing", "0/0"},
        {"of less than nothing", "1/-2"},
        {"letters behind", "0/2x"},
        {"an exponent", "1e0/2"},
        {"of more than there are numbers", "0/99999999999999999999"},
        {"letters alone", "a/b"}};
    cases.reserve(texts.size());
    for (const auto& [name, text] : texts)
        cases.push_back({"shards", fmt::format("--shard, {}", name), "accepted (1) or refused with a message (0)", 0,
                         "what is no part of a whole is refused", [text = text] {
                             try {
                                 (void)shade::parseShard(text);
                             } catch (const UsageError&) {
                                 return 0.0;
                             }
                             return 1.0;
                         }});
    return cases;
}

}  // namespace stratum::study
