#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace stratum {

std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
            diagonal = above;
        }
    }
    return row.back();
}

std::string_view nearestName(std::string_view word, std::span<const std::string_view> names) {
    constexpr std::size_t kMostLetters = 64;  // a word may be as long as a file
    word = word.substr(0, kMostLetters);
    std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
    std::string_view nearest;
    for (const std::string_view name : names) {
        const std::size_t distance = editDistance(word, name);
        // Names without a common letter are not suggested.
        if (distance >= least || distance >= std::max(word.size(), name.size())) continue;
        least = distance;
        nearest = name;
    }
    return nearest;
}

std::string didYouMean(std::string_view word, std::span<const std::string_view> names) {
    const std::string_view nearest = nearestName(word, names);
    return nearest.empty() ? std::string() : fmt::format("; did you mean '{}'?", nearest);
}

std::string didYouMean(std::string_view word, std::initializer_list<std::string_view> names) {
    return didYouMean(word, std::span<const std::string_view>(names.begin(), names.size()));
}

}  // namespace stratum
