#include "number_list.h"

#include "base/error.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace stratum::tools {

std::vector<int> parseIntegers(const std::string& text, std::size_t count, char separator, const char* option,
                               const char* expected) {
    std::vector<int> values;
    bool good = true;
    for (const std::string& word : CLI::detail::split(text, separator)) {
        const char* end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, values.emplace_back());
        good = good && error == std::errc{} && stop == end;
    }
    if (!good || values.size() != count) throw UsageError(fmt::format("{} {}: expected {}", option, text, expected));
    return values;
}

std::vector<double> parseNumbers(const std::string& text, std::initializer_list<std::size_t> counts, const char* option,
                                 const char* expected) {
    std::vector<double> values;
    bool good = true;
    for (const std::string& word : CLI::detail::split(text, ',')) {
        double value = 0;
        const char* end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data() + (word.starts_with('+') ? 1 : 0), end, value);
        good = good && error == std::errc{} && stop == end && std::isfinite(value);
        values.push_back(value);
    }
    if (!good || std::find(counts.begin(), counts.end(), values.size()) == counts.end())
        throw UsageError(
            fmt::format("{} {}: expected {}, numbers with commas between them and no spaces", option, text, expected));
    return values;
}

}  // namespace stratum::tools
