#include "gcode/container/unpack.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace stratum::gcode {
namespace {

// The most significant bit comes first. Past the end it returns zeros and sets `missing`.
class BitReader {
public:
    explicit BitReader(std::string_view bytes) : next_(bytes.data()), end_(bytes.data() + bytes.size()) {}

    // At least 56 bits are in the window afterwards, unless the bytes are used up.
    void refill() {
        if (end_ - next_ >= 8) {
            std::uint64_t word = 0;
            std::memcpy(&word, next_, 8);
            window_ |= __builtin_bswap64(word) >> count_;
            const int taken = (63 - count_) >> 3;
            next_ += taken;
            count_ += taken * 8;
            return;
        }
        while (count_ <= 56 && next_ != end_) {
            window_ |= std::uint64_t{static_cast<unsigned char>(*next_++)} << (56 - count_);
            count_ += 8;
        }
    }

    std::uint32_t take(int bits) {
        const auto value = static_cast<std::uint32_t>(window_ >> (64 - bits));
        window_ <<= bits;
        count_ -= bits;
        return value;
    }

    bool missing() const { return count_ < 0; }
    std::ptrdiff_t wholeBytesLeft() const { return end_ - next_ + count_ / 8; }

private:
    const char* next_;
    const char* end_;
    std::uint64_t window_ = 0;
    int count_ = 0;  // valid bits at the top of window_; below zero once more were taken than there are
};

// Byte by byte where source and destination overlap: that is how a run is written.
void copyBack(char* to, const char* begin, std::size_t distance, std::size_t length) {
    const auto before = static_cast<std::size_t>(to - begin);
    if (distance > before) {  // the window starts out as zeros
        const std::size_t zeros = std::min(length, distance - before);
        std::memset(to, 0, zeros);
        to += zeros;
        length -= zeros;
    }
    if (length <= distance) {
        if (length > 0) std::memcpy(to, to - distance, length);
        return;
    }
    for (; length > 0; --length, ++to) *to = *(to - distance);
}

}  // namespace

std::string_view decodeHeatshrink(std::string_view packed, int window_bits, int lookahead_bits, std::span<char> out) {
    BitReader bits(packed);
    char* to = out.data();
    char* const end = to + out.size();
    while (to != end) {
        bits.refill();
        if (bits.take(1) == 1) {
            *to++ = static_cast<char>(bits.take(8));
        } else {
            const std::size_t distance = std::size_t{bits.take(window_bits)} + 1;
            const std::size_t length = std::size_t{bits.take(lookahead_bits)} + 1;
            if (length > static_cast<std::size_t>(end - to)) {
                if (bits.missing()) break;
                return "its heatshrink data goes on past the size that its header states";
            }
            copyBack(to, out.data(), distance, length);
            to += length;
        }
        if (bits.missing()) break;
    }
    if (bits.missing()) return "its heatshrink data ends before the size that its header states";
    // The encoder fills its last byte with zeros and may add one more.
    if (bits.wholeBytesLeft() > 1) return "its heatshrink data is longer than the size that its header states";
    return {};
}

}  // namespace stratum::gcode
