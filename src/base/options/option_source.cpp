#include "base/options/option_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace stratum {

std::optional<double> OptionSource::numberIn(std::string_view name, double least, double most) {
    const std::optional<double> value = number(name);
    if (value && !(*value >= least && *value <= most))
        refuse(name, fmt::format("a number from {:g} to {:g}", least, most));
    return value;
}

std::vector<double> OptionSource::numbersOf(std::string_view name, std::initializer_list<std::size_t> counts,
                                            std::string_view expected, char separator) {
    std::vector<double> values = list(name, separator);
    if (!values.empty() && std::find(counts.begin(), counts.end(), values.size()) == counts.end()) fail(name, expected);
    return values;
}

std::vector<int> OptionSource::integersOf(std::string_view name, std::size_t count, std::string_view expected,
                                          char separator) {
    constexpr double kMost = 1e9;
    const std::vector<double> values = numbersOf(name, {count}, expected, separator);
    std::vector<int> integers;
    for (const double value : values) {
        if (std::abs(value) > kMost || value != std::floor(value)) fail(name, expected);
        integers.push_back(static_cast<int>(value));
    }
    return integers;
}

std::optional<glm::dvec3> OptionSource::point(std::string_view name) {
    const std::vector<double> v = numbersOf(name, {3}, "three numbers, x, y, z");
    if (v.empty()) return std::nullopt;
    return glm::dvec3(v[0], v[1], v[2]);
}

std::string OptionSource::oneOf(std::string_view given, std::span<const std::string_view> names) {
    return fmt::format("one of {}{}", fmt::join(names, ", "), didYouMean(given, names));
}

}  // namespace stratum
