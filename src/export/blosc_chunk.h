// The values of a leaf -> a chunk of Blosc 1, with the bytes that c-blosc makes of them.
//
// OpenVDB packs each leaf by itself: up to 2 KB, their bytes shuffled, in four streams of LZ4. For each stream c-blosc
// clears LZ4's table of 16 KB, 32 times the stream itself; here the table stays from stream to stream, which LZ4
// provides for. The format is that of README_CHUNK_FORMAT.rst of c-blosc 1.21.
#pragma once

#include <cstddef>
#include <span>

namespace stratum::exporter {

constexpr std::size_t kMostChunkValues = 512;
/// A chunk has at most so many bytes more than its values.
constexpr std::size_t kChunkOverhead = 16;

/// Writes the chunk of blosc_compress_ctx() at level 9 with the shuffle of bytes, LZ4, and all values in one block;
/// returns its bytes. From any thread.
std::size_t packChunk(std::span<const float> values, char* chunk);

}  // namespace stratum::exporter
