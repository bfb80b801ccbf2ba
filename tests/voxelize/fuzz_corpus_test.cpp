#include "fuzz/corpus_runner.h"

extern "C" int fuzzDeposit(const std::uint8_t* data, std::size_t size);  // fuzz/deposit_fuzz.cpp

namespace stratum::voxelize {
namespace {

TEST(FuzzCorpus, Beads) { EXPECT_GE(test::runFuzzCorpus("deposit", fuzzDeposit), 8U); }

}  // namespace
}  // namespace stratum::voxelize
