#include "gcode/container/gzip.h"

#include "base/error.h"
#include "gcode/container_samples.h"
#include "refusal.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

std::string gzipError(std::string_view bytes, const ContainerLimits& limits = {}) {
    return test::messageOf<InputError>([&] { openGzip(bytes, "a.gz", limits); });
}

TEST(Gzip, MembersInARow) {
    const std::string text = sample::program(50);
    EXPECT_EQ(openGzip(sample::gzip(text), "a", {}).text, text);
    EXPECT_EQ(openGzip(sample::gzip(text) + sample::gzip("") + sample::gzip("M84\n"), "a", {}).text, text + "M84\n");
    EXPECT_EQ(openGzip(sample::gzip(text) + std::string(512, '\0'), "a", {}).text, text);
    EXPECT_EQ(openGzip(sample::gzip(""), "a", {}).text, "");
}

TEST(Gzip, LargerThanAnyChunk) {
    std::string text = sample::program(30000);
    text.resize(std::size_t{5} << 20, '\n');
    EXPECT_TRUE(openGzip(sample::gzip(text), "a", {}).text == text);
}

TEST(Gzip, DamageIsNamed) {
    const std::string text = sample::program(50);
    const std::string packed = sample::gzip(text);
    EXPECT_NE(gzipError(packed.substr(0, packed.size() / 2)).find("member 1 at byte"), std::string::npos);
    EXPECT_NE(gzipError(packed + "garbage").find("another gzip member"), std::string::npos);
    const std::string second = gzipError(packed + packed.substr(0, 100));
    EXPECT_NE(second.find("a.gz: gzip member 2 at byte"), std::string::npos) << second;
    std::string flipped = packed;
    flipped[flipped.size() - 6] ^= 1;
    EXPECT_NE(gzipError(flipped).find("damaged"), std::string::npos);
}

TEST(Gzip, ABombIsStopped) {
    const std::string bomb = sample::gzip(std::string(std::size_t{9} << 20, 'G'));
    ContainerLimits limits;
    limits.any_ratio_bytes = 1 << 20;
    EXPECT_NE(gzipError(bomb, limits).find("unpacks to more than"), std::string::npos);
    limits.any_ratio_bytes = std::size_t{64} << 20;
    EXPECT_EQ(gzipError(bomb, limits), "");
    limits.most_bytes = 1 << 20;
    EXPECT_NE(gzipError(bomb, limits).find("unpacks to more than"), std::string::npos);
}

}  // namespace
}  // namespace stratum::gcode
