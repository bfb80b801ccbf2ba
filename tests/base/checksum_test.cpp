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

TEST(Checksum, GoesOnAndIsPutTogether) {
    std::mt19937 random(1);
    std::string bytes(100'000, ' ');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::uint32_t all = checksumOf(bytes);
    for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{4097}, bytes.size()}) {
        const std::string_view text = bytes;
        const std::uint32_t first = checksumOf(text.substr(0, cut));
        EXPECT_EQ(checksumOf(text.substr(cut), first), all);
        EXPECT_EQ(checksumOfBoth(first, checksumOf(text.substr(cut)), bytes.size() - cut), all);
    }
    const std::vector<double> values = {1.5, -2, 0};
    EXPECT_EQ(checksumOf(values.data(), 3),
              checksumOf(std::string_view(reinterpret_cast<const char*>(values.data()), 3 * sizeof(double))));
}

}  // namespace
}  // namespace stratum
