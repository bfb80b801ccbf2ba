// Sizes and counts as short text for people.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace stratum {

/// "1.23 GB", "45.6 MB", "789 B"; powers of ten.
std::string humanBytes(double bytes);
/// "12.3 M", "45.6 k", "789".
std::string humanCount(double count);
/// "1 layer", "2 layers".
std::string counted(std::size_t number, std::string_view noun);

}  // namespace stratum
