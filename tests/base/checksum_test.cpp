#include "base/checksum.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace stratum {
namespace {

TEST(Checksum, IsTheOneOfZipAndPng) {
    EXPECT_EQ(checksumOf("123456789"), 0xcbf43926U);  // the check value of CRC-32
    EXPECT_EQ(checksumOf(""), 0U);
}

TEST(Checksum, GoesOn) {
    std::mt19937 random(1);
    std::string bytes(100'000, ' ');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::uint32_t all = checksumOf(bytes);
    for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{4097}, bytes.size()}) {
        const std::string_view text = bytes;
        EXPECT_EQ(checksumOf(text.substr(cut), checksumOf(text.substr(0, cut))), all);
    }
    const std::vector<double> values = {1.5, -2, 0};
    EXPECT_EQ(checksumOf(values.data(), 3),
              checksumOf(std::string_view(reinterpret_cast<const char*>(values.data()), 3 * sizeof(double))));
}

TEST(Sha256, KnownAnswers) {
    // FIPS 180-2, appendix B.1, and the empty message.
    EXPECT_EQ(sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

}  // namespace
}  // namespace stratum
