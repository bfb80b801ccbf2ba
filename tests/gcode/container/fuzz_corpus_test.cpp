#include "fuzz/corpus_runner.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);  // fuzz/container_fuzz.cpp

namespace stratum::gcode {
namespace {

TEST(FuzzCorpus, Containers) { EXPECT_GT(test::runFuzzCorpus("container", LLVMFuzzerTestOneInput), 50U); }

}  // namespace
}  // namespace stratum::gcode
