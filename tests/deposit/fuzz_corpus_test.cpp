#include "fuzz/corpus_runner.h"

extern "C" int fuzzPrinter(const std::uint8_t* data, std::size_t size);  // fuzz/printer_fuzz.cpp

namespace stratum::deposit {
namespace {

TEST(FuzzCorpus, Printers) { EXPECT_GT(test::runFuzzCorpus("printer", fuzzPrinter), 6U); }

}  // namespace
}  // namespace stratum::deposit
