#include "fuzz/corpus_runner.h"

extern "C" int fuzzPath(const std::uint8_t* data, std::size_t size);  // fuzz/path_fuzz.cpp

namespace stratum::animate {
namespace {

TEST(FuzzCorpus, CameraPaths) { EXPECT_GE(test::runFuzzCorpus("path", fuzzPath), 3U); }

}  // namespace
}  // namespace stratum::animate
