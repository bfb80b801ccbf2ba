#include "fuzz/corpus_runner.h"

extern "C" int fuzzMap(const std::uint8_t* data, std::size_t size);   // fuzz/map_fuzz.cpp
extern "C" int fuzzBrdf(const std::uint8_t* data, std::size_t size);  // fuzz/brdf_fuzz.cpp
extern "C" int fuzzPart(const std::uint8_t* data, std::size_t size);  // fuzz/part_fuzz.cpp

namespace stratum::shade {
namespace {

TEST(FuzzCorpus, MapsOfLight) { EXPECT_GT(test::runFuzzCorpus("map", fuzzMap), 15U); }
TEST(FuzzCorpus, PartsOfPictures) { EXPECT_GT(test::runFuzzCorpus("part", fuzzPart), 3U); }
TEST(FuzzCorpus, MeasuredMaterials) { EXPECT_GT(test::runFuzzCorpus("brdf", fuzzBrdf), 10U); }

}  // namespace
}  // namespace stratum::shade
