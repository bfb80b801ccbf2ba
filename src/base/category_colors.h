// Colors that tell small numbers apart: tools, objects, features without a color of their own.
// Source: the set of M. Okabe and K. Ito for all kinds of color vision (2008), with three more.
#pragma once

#include <array>
#include <cstdint>

namespace stratum {

/// 0xRRGGBB, sRGB. Number n has the color n modulo their count.
inline constexpr std::array<std::uint32_t, 10> kCategoryColors = {0xe69f00, 0x0072b2, 0x009e73, 0xd55e00, 0xcc79a7,
                                                                  0x56b4e9, 0xf0e442, 0x7a4a2a, 0x8a8a8a, 0x2f2f4f};

}  // namespace stratum
