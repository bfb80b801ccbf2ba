// The number grammar of G-code: [+-] digits with at most one dot, which may come first or last. No exponent: X1E5 is
// the two words X1 and E5. But "1.5e-05", a small e with a sign and two digits or more, is a small number as Python's
// and C's libraries write it. "nan", "inf" and hexadecimal are not numbers.
// Sources: NIST RS274/NGC 3.3.2.1; Marlin's parser.h, which cuts a value at 'E' before it calls strtof.
#pragma once

#include <fast_float/fast_float.h>

#include <array>
#include <cstdint>
#include <limits>
#include <system_error>

namespace stratum::gcode {

/// Two digits or more, and no dot behind them.
inline bool isExponent(const char* p, const char* end) {
    const char* const first = p;
    while (p != end && static_cast<unsigned char>(*p) - static_cast<unsigned>('0') <= 9) ++p;
    return p - first >= 2 && (p == end || *p != '.');
}

/// Reads the longest number at `p` and advances `p` past it. Returns false and changes neither argument if there is
/// none. The value is the nearest double; it is infinite if the digits exceed a double's range.
inline bool parseNumber(const char*& p, const char* end, double& value) {
    static constexpr std::array<double, 19> kPowersOfTen{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
                                                         1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};
    const char* s = p;
    bool negative = false;
    if (s != end && (*s == '-' || *s == '+')) negative = *s++ == '-';
    const char* const first = s;
    std::uint64_t mantissa = 0;
    const auto takeDigits = [&] {
        const char* const start = s;
        for (; s != end; ++s) {
            const unsigned digit = static_cast<unsigned char>(*s) - static_cast<unsigned>('0');
            if (digit > 9) break;
            mantissa = mantissa * 10 + digit;
        }
        return s - start;
    };
    const std::ptrdiff_t whole = takeDigits();
    std::ptrdiff_t fraction = 0;
    if (s != end && *s == '.') {
        ++s;
        fraction = takeDigits();
    }
    if (whole + fraction == 0) return false;
    double magnitude = 0;
    if (whole + fraction <= 18 && mantissa <= (std::uint64_t{1} << 53)) {
        // Both operands are exact, so the result is rounded only once (Clinger's fast path).
        magnitude = static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(fraction)];
    } else {
        fast_float::from_chars(first, s, magnitude, fast_float::chars_format::fixed);
    }
    if (end - s > 3 && *s == 'e' && (s[1] == '-' || s[1] == '+') && isExponent(s + 2, end)) {
        const auto read = fast_float::from_chars(first, end, magnitude);
        if (read.ec == std::errc{}) s = read.ptr;
        if (read.ec == std::errc::result_out_of_range) {
            magnitude = s[1] == '-' ? 0 : std::numeric_limits<double>::infinity();
            s = read.ptr;
        }
    }
    value = negative ? -magnitude : magnitude;
    p = s;
    return true;
}

}  // namespace stratum::gcode
