// Where the tests find real input.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace stratum::test {

/// The root of this checkout.
std::filesystem::path sourceDir();

/// The project's own small inputs; always there.
inline std::filesystem::path dataDir() { return sourceDir() / "data"; }

/// The corpus of real files: $STRATUM_CORPUS, or ../shared/corpus beside the project. May be missing.
inline std::filesystem::path corpusDir() {
    if (const char* path = std::getenv("STRATUM_CORPUS")) return path;
    return sourceDir() / ".." / "shared" / "corpus";
}

}  // namespace stratum::test

/// Skips a test by name when a file of the corpus is not there.
#define STRATUM_NEEDS_CORPUS(variable, relative)                                      \
    const std::filesystem::path variable = ::stratum::test::corpusDir() / (relative); \
    if (!std::filesystem::exists(variable)) GTEST_SKIP() << "corpus file " << (relative) << " is not there"
