// What reaches the readers' corners and what fuzzers once broke them with, once more without a fuzzer: nothing may
// escape, crash or hang.
#include "corpus.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

// The targets themselves, each under a name of its own.
extern "C" int fuzzScene(const std::uint8_t* data, std::size_t size);  // fuzz/scene_fuzz.cpp
extern "C" int fuzzMap(const std::uint8_t* data, std::size_t size);    // fuzz/map_fuzz.cpp
extern "C" int fuzzBrdf(const std::uint8_t* data, std::size_t size);   // fuzz/brdf_fuzz.cpp

namespace stratum::shade {
namespace {

std::size_t runAll(const char* folder, int (*target)(const std::uint8_t*, std::size_t)) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::sourceDir() / "tests/fuzz" / folder)) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        SCOPED_TRACE(entry.path());
        EXPECT_EQ(target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    return files;
}

TEST(FuzzCorpus, Scenes) { EXPECT_GT(runAll("scene", fuzzScene), 8U); }
TEST(FuzzCorpus, MapsOfLight) { EXPECT_GT(runAll("map", fuzzMap), 15U); }
TEST(FuzzCorpus, MeasuredMaterials) { EXPECT_GT(runAll("brdf", fuzzBrdf), 10U); }

}  // namespace
}  // namespace stratum::shade
