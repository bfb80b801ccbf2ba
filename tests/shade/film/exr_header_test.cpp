#include "shade/film/exr.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/map_files.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <string>

namespace stratum::shade {
namespace {

constexpr std::size_t kMost = std::size_t{1} << 27;

std::string smallMap() {
    const test::ScratchFolder scratch;
    test::writeExrMap(scratch / "map.exr", 8, 4, std::vector<Color>(32, Color(1.0f)));
    return test::bytesOf(scratch / "map.exr");
}

/// Puts a number `behind` bytes behind the name, type and size of an attribute.
std::string with(std::string bytes, const std::string& name, const std::string& type, std::size_t behind,
                 std::int32_t value) {
    const std::size_t at = bytes.find(name + '\0' + type + '\0');
    EXPECT_NE(at, std::string::npos) << name;
    std::memcpy(bytes.data() + at + name.size() + type.size() + 6 + behind, &value, sizeof value);
    return bytes;
}

std::string refusal(const std::string& bytes, std::size_t most = kMost) {
    return test::messageOf<InputError>([&] { checkExrHeader(bytes, most, "map.exr"); });
}

TEST(ExrHeader, AcceptsWhatOpenExrWrote) {
    EXPECT_EQ(refusal(smallMap()), "");
    EXPECT_NE(refusal(smallMap(), 31).find("at most 31"), std::string::npos);
}

TEST(ExrHeader, RefusesEveryCutThatReachesIt) {
    const std::string bytes = smallMap();
    for (std::size_t size = 4; size < 200; ++size) EXPECT_NE(refusal(bytes.substr(0, size)), "") << size;
}

// A window that no file of this length can fill; one that is inside out; one at the end of the numbers.
TEST(ExrHeader, RefusesAWindowThatTheBytesCantFill) {
    EXPECT_NE(refusal(with(smallMap(), "dataWindow", "box2i", 8, 131071)).find("131072 x 4"), std::string::npos);
    EXPECT_NE(refusal(with(with(smallMap(), "dataWindow", "box2i", 8, 8191), "dataWindow", "box2i", 12, 4095))
                  .find("more chunks"),
              std::string::npos);
    EXPECT_NE(refusal(with(smallMap(), "dataWindow", "box2i", 8, -5)), "");
    EXPECT_NE(refusal(with(smallMap(), "dataWindow", "box2i", 0, -2147483647)), "");
}

TEST(ExrHeader, RefusesAttributesLongerThanTheFile) {
    std::string bytes = smallMap();
    const std::string name = "channels" + std::string(1, '\0') + "chlist" + std::string(1, '\0');
    const std::int32_t size = 0x7fffffff;
    std::memcpy(bytes.data() + bytes.find(name) + name.size(), &size, sizeof size);
    EXPECT_NE(refusal(bytes).find("ends early"), std::string::npos);
}

// OpenEXR would read on from where a value of its kind ends.
TEST(ExrHeader, RefusesValuesOfAnotherSizeThanTheirKind) {
    std::string bytes = smallMap();
    const std::string name = "lineOrder" + std::string(1, '\0') + "lineOrder" + std::string(1, '\0');
    const std::size_t at = bytes.find(name) + name.size();
    bytes[at] = 2;
    bytes.insert(at + 4, 1, '\0');
    EXPECT_NE(refusal(bytes).find("lineOrder"), std::string::npos);
    bytes = smallMap();
    const std::string list = "channels" + std::string(1, '\0') + "chlist" + std::string(1, '\0');
    const std::size_t size = bytes.find(list) + list.size();
    const auto longer = static_cast<char>(bytes[size] + 1);
    bytes.insert(size + 4 + static_cast<std::size_t>(bytes[size]), 1, '\0');
    bytes[size] = longer;
    EXPECT_NE(refusal(bytes).find("channels"), std::string::npos);
}

TEST(ExrHeader, RefusesDeepData) {
    std::string bytes = smallMap();
    bytes[5] = static_cast<char>(bytes[5] | 0x08);
    EXPECT_NE(refusal(bytes).find("deep"), std::string::npos);
}

}  // namespace
}  // namespace stratum::shade
