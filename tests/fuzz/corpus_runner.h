// The files of a fuzz corpus, once more without a fuzzer: nothing may escape, crash or hang.
#pragma once

#include "corpus.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace stratum::test {

/// Gives every file of tests/fuzz/`folder` to a fuzz target; returns how many there were.
inline std::size_t runFuzzCorpus(const char* folder, int (*target)(const std::uint8_t*, std::size_t)) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(sourceDir() / "tests/fuzz" / folder)) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        SCOPED_TRACE(entry.path());
        EXPECT_EQ(target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    return files;
}

}  // namespace stratum::test
