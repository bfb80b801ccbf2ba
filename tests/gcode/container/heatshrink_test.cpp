#include "gcode/container/unpack.h"

#include "gcode/container_samples.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace stratum::gcode {
namespace {

using namespace std::string_literals;

std::string decode(std::string_view packed, int window, int lookahead, std::size_t size) {
    std::string out(size, '?');
    const std::string_view problem = decodeHeatshrink(packed, window, lookahead, out);
    return problem.empty() ? out : std::string("!").append(problem);
}

TEST(Heatshrink, HandMade) {
    // 1 and 'G', 1 and '1', then 0, index 1 (11 bits), count 5 (4 bits): "G1" and 6 characters from 2 back, in bits
    // 101000111 100110001 0 00000000001 0101 = 1010 0011 1100 1100 0100 0000 0000 0101 01
    EXPECT_EQ(decode("\xa3\xcc\x40\x05\x40"s, 11, 4, 8), "G1G1G1G1");
    // the same with 12 bits of index
    EXPECT_EQ(decode("\xa3\xcc\x40\x02\xa0"s, 12, 4, 8), "G1G1G1G1");
    EXPECT_EQ(decode("", 11, 4, 0), "");
}

TEST(Heatshrink, BeforeTheStartThereAreZeros) {
    // 0, index 2 (11 bits), count 3: four bytes from 3 back, and there is nothing
    EXPECT_EQ(decode("\x00\x23"s, 11, 4, 4), "\0\0\0\0"s);
}

TEST(Heatshrink, RoundTrips) {
    std::mt19937 random(7);
    for (const unsigned window : {4U, 8U, 11U, 12U, 15U}) {
        for (std::size_t size : {1, 2, 7, 100, 5000}) {
            std::string text(size, ' ');
            for (char& c : text) c = static_cast<char>("G1 X0.5\n\xff"[random() % 9]);
            const std::string packed = sample::heatshrink(text, window, 3 + window % 2);
            EXPECT_EQ(decode(packed, static_cast<int>(window), 3 + static_cast<int>(window % 2), size), text);
        }
    }
}

TEST(Heatshrink, CutOrPromisedWrongly) {
    const std::string text = sample::program(2);
    const std::string packed = sample::heatshrink(text, 11, 4);
    for (std::size_t n = 0; n < packed.size(); ++n)
        ASSERT_EQ(decode(packed.substr(0, n), 11, 4, text.size()).front(), '!') << n;
    EXPECT_EQ(decode(packed, 11, 4, text.size() + 20).front(), '!');
    EXPECT_EQ(decode(packed, 11, 4, text.size() - 40).front(), '!');
}

}  // namespace
}  // namespace stratum::gcode
