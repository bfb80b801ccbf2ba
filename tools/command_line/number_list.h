// Numbers in a row as the value of one option: "1280x960", "0,0,1".
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

namespace stratum::tools {

/// Exactly `count` whole numbers with `separator` between them. Throws UsageError, which says what was expected of the
/// option.
std::vector<int> parseIntegers(const std::string& text, std::size_t count, char separator, const char* option,
                               const char* expected);

/// Finite numbers with commas between them, as many as one of `counts`. Throws UsageError likewise.
std::vector<double> parseNumbers(const std::string& text, std::initializer_list<std::size_t> counts, const char* option,
                                 const char* expected);

}  // namespace stratum::tools
