#include "fuzz/corpus_runner.h"

extern "C" int fuzzScene(const std::uint8_t* data, std::size_t size);  // fuzz/scene_fuzz.cpp

namespace stratum::assemble {
namespace {

TEST(FuzzCorpus, Scenes) { EXPECT_GT(test::runFuzzCorpus("scene", fuzzScene), 8U); }

}  // namespace
}  // namespace stratum::assemble
