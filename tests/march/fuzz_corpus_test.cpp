// .vdb files that reach the reader's corners, and what a fuzzer once broke it with, once more without the fuzzer:
// nothing may escape, crash or hang.
#include "corpus.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int fuzzVdb(const std::uint8_t* data, std::size_t size);  // fuzz/vdb_fuzz.cpp, by another name

namespace stratum::march {
namespace {

TEST(FuzzCorpus, VdbFiles) {
    openvdb::initialize();
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::sourceDir() / "tests/fuzz/vdb")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        SCOPED_TRACE(entry.path());
        EXPECT_EQ(fuzzVdb(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    EXPECT_GT(files, 10U);
}

}  // namespace
}  // namespace stratum::march
