// A double that may lie at any multiple of four bytes, so that a record of doubles and one word has no padding.
// It holds every bit and reads as a double does; where a template wants the type itself, write double{value}.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace stratum::gcode {

class PackedDouble {
public:
    constexpr PackedDouble() = default;
    constexpr PackedDouble(double value)  // NOLINT(google-explicit-constructor): it is one
        : words_(std::bit_cast<std::array<std::uint32_t, 2>>(value)) {}
    constexpr operator double() const { return std::bit_cast<double>(words_); }  // NOLINT(google-explicit-constructor)
    constexpr PackedDouble& operator+=(double change) { return *this = *this + change; }
    constexpr PackedDouble& operator-=(double change) { return *this = *this - change; }
    constexpr PackedDouble& operator*=(double factor) { return *this = *this * factor; }

private:
    std::array<std::uint32_t, 2> words_{};
};
static_assert(sizeof(PackedDouble) == 8 && alignof(PackedDouble) == 4);

}  // namespace stratum::gcode
