#include "export/leaf_packer.h"

#include <blosc.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <thread>
#include <vector>

namespace stratum::exporter {
namespace {

std::vector<char> ofBlosc(const std::vector<float>& values) {
    const std::size_t bytes = values.size() * sizeof(float);
    std::vector<char> chunk(bytes + BLOSC_MAX_OVERHEAD);
    const int size = blosc_compress_ctx(9, BLOSC_SHUFFLE, sizeof(float), bytes, values.data(), chunk.data(),
                                        chunk.size(), BLOSC_LZ4_COMPNAME, bytes, 1);
    chunk.resize(static_cast<std::size_t>(size));
    return chunk;
}

std::vector<char> ofOurs(const std::vector<float>& values) {
    std::vector<char> chunk(values.size() * sizeof(float) + kChunkOverhead);
    chunk.resize(packChunk(values, chunk.data()));
    return chunk;
}

void expectSameChunks(unsigned seed) {
    std::mt19937 random(seed);
    const auto bits = [&random](std::size_t) { return std::bit_cast<float>(static_cast<std::uint32_t>(random())); };
    // From what packs best to what does not pack at all, and what packs in some streams only.
    const std::function<float(std::size_t)> kinds[] = {
        [](std::size_t) { return 0.3F; },
        [](std::size_t n) { return static_cast<float>(n % 8) * 0.1F - 0.35F; },
        [&](std::size_t n) { return std::sqrt(static_cast<float>(n + 3 * seed)) - 10; },
        [&](std::size_t n) { return n % 3 == 0 ? bits(n) : 0.1F; },
        [&](std::size_t n) { return n < 200 ? bits(n) : 0.25F; },
        [&](std::size_t) { return static_cast<float>(random() % 1000) * 0.001F; },
        bits,
    };
    for (const auto& kind : kinds)
        for (std::size_t count = 1; count <= kMostChunkValues; count += count < 140 ? 1 : 31) {
            std::vector<float> values(count);
            for (std::size_t n = 0; n < count; ++n) values[n] = kind(n);
            ASSERT_EQ(ofOurs(values), ofBlosc(values)) << "kind " << &kind - kinds << ", " << count << " values";
        }
}

TEST(BloscChunk, HasTheBytesOfBlosc) {
    for (unsigned seed = 0; seed < 10; ++seed) expectSameChunks(seed);
}

// Each thread has a table of its own.
TEST(BloscChunk, HasTheBytesOfBloscInAnyThread) {
    std::vector<std::thread> threads;
    for (unsigned n = 0; n < 4; ++n) threads.emplace_back([n] { expectSameChunks(100 + n); });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace stratum::exporter
