// The names of an enumeration's values: one table for command lines, scene files, Python and the viewer.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace stratum {

template <typename Value, std::size_t N>
using Names = std::array<std::pair<std::string_view, Value>, N>;

/// The value of a name; nullopt if it is none.
template <typename Value, std::size_t N>
std::optional<Value> valueOf(const Names<Value, N>& names, std::string_view name) {
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == name; });
    return found != names.end() ? std::optional(found->second) : std::nullopt;
}

/// The name of a value, which must be in the table.
template <typename Value, std::size_t N>
std::string_view nameOf(const Names<Value, N>& names, Value value) {
    return std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.second == value; })->first;
}

/// All names.
template <typename Value, std::size_t N>
std::array<std::string_view, N> listOf(const Names<Value, N>& names) {
    std::array<std::string_view, N> list;
    std::transform(names.begin(), names.end(), list.begin(), [](const auto& entry) { return entry.first; });
    return list;
}

// Suggests names for a mistyped word.

/// Levenshtein's distance: single letters inserted, removed or replaced.
std::size_t editDistance(std::string_view a, std::string_view b);

/// The name nearest to `word`, if the distance is at most a third of its letters (at least one); else empty. Of several
/// the first. Only the first 64 letters of `word` are used.
std::string_view nearestName(std::string_view word, std::span<const std::string_view> names);

/// For the end of a message: "; did you mean 'studio'?", or nothing.
std::string didYouMean(std::string_view word, std::span<const std::string_view> names);
std::string didYouMean(std::string_view word, std::initializer_list<std::string_view> names);

}  // namespace stratum
