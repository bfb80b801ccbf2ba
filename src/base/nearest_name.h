// A mistyped word and the names that it may stand for.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace stratum {

/// Levenshtein's distance: single letters inserted, removed or replaced.
std::size_t editDistance(std::string_view a, std::string_view b);

/// The name that is nearest to `word`, if no more than a third of its letters (but at least one) are wrong; empty if
/// none is. Of several the first. Only the first 64 letters of `word` count.
std::string_view nearestName(std::string_view word, std::span<const std::string_view> names);

/// For the end of a message: "; did you mean 'studio'?", or nothing.
std::string didYouMean(std::string_view word, std::span<const std::string_view> names);
std::string didYouMean(std::string_view word, std::initializer_list<std::string_view> names);

}  // namespace stratum
