// Programs that reach every corner a fuzzer has found, once more without it: nothing may escape, crash or hang.
#include "corpus.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

// The target itself, under another name: the containers' has the same.
#define LLVMFuzzerTestOneInput fuzzGcode
#include "fuzz/gcode_fuzz.cpp"

namespace stratum::gcode {
namespace {

TEST(FuzzCorpus, Programs) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::sourceDir() / "tests/fuzz/gcode")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        SCOPED_TRACE(entry.path());
        EXPECT_EQ(fuzzGcode(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    EXPECT_GT(files, 200U);
}

}  // namespace
}  // namespace stratum::gcode
