// What the fuzzers found worth keeping, once more without them: nothing may escape, crash or hang.
#include "corpus.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);  // fuzz/container_fuzz.cpp

namespace stratum::gcode {
namespace {

TEST(FuzzCorpus, Containers) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::sourceDir() / "tests/fuzz/container")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        SCOPED_TRACE(entry.path());
        EXPECT_EQ(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    EXPECT_GT(files, 100U);
}

}  // namespace
}  // namespace stratum::gcode
