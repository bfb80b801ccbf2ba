// Programs that reach every corner a fuzzer has found.
#include "fuzz/corpus_runner.h"

// The target itself, under another name: the containers' has the same.
#define LLVMFuzzerTestOneInput fuzzGcode
#include "fuzz/gcode_fuzz.cpp"

namespace stratum::gcode {
namespace {

TEST(FuzzCorpus, Programs) { EXPECT_GT(test::runFuzzCorpus("gcode", fuzzGcode), 50U); }

}  // namespace
}  // namespace stratum::gcode
