#include "fuzz/corpus_runner.h"

#include <openvdb/openvdb.h>

extern "C" int fuzzVdb(const std::uint8_t* data, std::size_t size);  // fuzz/vdb_fuzz.cpp

namespace stratum::march {
namespace {

TEST(FuzzCorpus, VdbFiles) {
    openvdb::initialize();
    EXPECT_GT(test::runFuzzCorpus("vdb", fuzzVdb), 10U);
}

}  // namespace
}  // namespace stratum::march
