#include "fuzz/corpus_runner.h"

extern "C" int fuzzModel(const std::uint8_t* data, std::size_t size);  // fuzz/model_fuzz.cpp

namespace stratum::compare {
namespace {

TEST(FuzzCorpus, Models) { EXPECT_GT(test::runFuzzCorpus("model", fuzzModel), 5U); }

}  // namespace
}  // namespace stratum::compare
