// Suggests names for a mistyped word.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace stratum {

/// Levenshtein's distance: single letters inserted, removed or replaced.
std::size_t editDistance(std::string_view a, std::string_view b);

/// The name nearest to `word`, if the distance is at most a third of its letters (at least one); else empty. Of several
/// the first. Only the first 64 letters of `word` are used.
std::string_view nearestName(std::string_view word, std::span<const std::string_view> names);

/// For the end of a message: "; did you mean 'studio'?", or nothing.
std::string didYouMean(std::string_view word, std::span<const std::string_view> names);
std::string didYouMean(std::string_view word, std::initializer_list<std::string_view> names);

}  // namespace stratum
