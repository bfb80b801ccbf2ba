#include "gcode/container/unpack.h"

#include <array>

namespace stratum::gcode {
namespace {

// Two signal bytes and one of these change the state.
constexpr unsigned char kSignal = 0xff;
enum PackCommand : unsigned char {
    kSpacesStay = 246,
    kSpacesGone = 247,
    kQuery = 248,
    kReset = 249,
    kPackingOff = 250,
    kPackingOn = 251,
};

constexpr unsigned kFull = 15;  // the nibble that says: this character follows as a byte of its own
constexpr std::size_t kSpace = 11;
constexpr std::array<char, 16> kCharacters{'0', '1', '2', '3', '4',  '5', '6', '7',
                                           '8', '9', '.', ' ', '\n', 'G', 'X', '\0'};

}  // namespace

std::string_view unpackMeatPack(std::string_view packed, ByteBuffer& text) {
    constexpr std::string_view cut = "its MeatPack data ends in the middle of a character or a command";
    const std::size_t before = text.size();
    char* const start = text.extend(2 * packed.size());
    char* out = start;
    std::array<char, 16> characters = kCharacters;
    bool packing = false;

    const auto* p = reinterpret_cast<const unsigned char*>(packed.data());
    const auto* const end = p + packed.size();
    while (p != end) {
        const unsigned char c = *p++;
        if (c == kSignal && p != end && *p == kSignal) {
            if (end - p < 2) return cut;
            switch (p[1]) {
                case kPackingOn:
                    packing = true;
                    break;
                case kPackingOff:
                case kReset:
                    packing = false;
                    break;
                case kSpacesGone:
                    characters[kSpace] = 'E';
                    break;
                case kSpacesStay:
                    characters[kSpace] = ' ';
                    break;
                case kQuery:
                    break;
                default:
                    return "its MeatPack data has a command that is not known";
            }
            p += 2;
            continue;
        }
        if (!packing) {
            *out++ = static_cast<char>(c);
            continue;
        }
        const unsigned low = c & 15U;
        const unsigned high = c >> 4U;
        if (low == kFull) {
            if (p == end) return cut;
            *out++ = static_cast<char>(*p++);
        } else {
            *out++ = characters[low];
            if (characters[low] == '\n') continue;  // the other half only fills the byte
        }
        if (high == kFull) {
            if (p == end) return cut;
            *out++ = static_cast<char>(*p++);
        } else {
            *out++ = characters[high];
        }
    }
    text.truncate(before + static_cast<std::size_t>(out - start));
    return {};
}

}  // namespace stratum::gcode
