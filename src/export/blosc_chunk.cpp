#include "export/blosc_chunk.h"

#include <hwy/highway.h>

// For the function that keeps its table, which only the static library has.
#define LZ4_STATIC_LINKING_ONLY
#include <lz4.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace stratum::exporter {
namespace {

static_assert(std::endian::native == std::endian::little, "chunks are");

namespace hn = hwy::HWY_NAMESPACE;

// Of the chunk's head, at byte 2.
enum Flags : std::uint8_t { kShuffled = 1, kStored = 2, kOneStream = 16, kLz4 = 32 };

constexpr std::size_t kHeadBytes = kChunkOverhead;
constexpr std::size_t kFirstStream = kHeadBytes + sizeof(std::uint32_t);  // behind the place of the only block
constexpr std::size_t kLeastPackedBytes = 128;                            // fewer are stored
constexpr std::size_t kLeastSplitValues = 128;                            // fewer are one stream

struct Lz4Table {
    Lz4Table() { LZ4_initStream(&stream, sizeof stream); }
    LZ4_stream_t stream;
};

void put(std::size_t number, char* at) {
    const auto stored = static_cast<std::uint32_t>(number);
    std::memcpy(at, &stored, sizeof stored);
}

// The first bytes of all values, then their second ones, and so on.
void shuffle(std::span<const float> values, std::uint8_t* out) {
    const hn::CappedTag<std::uint8_t, 16> d;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    const std::size_t count = values.size();
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) {
        hn::Vec<decltype(d)> part[sizeof(float)];
        hn::LoadInterleaved4(d, bytes + n * sizeof(float), part[0], part[1], part[2], part[3]);
        for (std::size_t byte = 0; byte < sizeof(float); ++byte) hn::StoreU(part[byte], d, out + byte * count + n);
    }
    for (; n < count; ++n)
        for (std::size_t byte = 0; byte < sizeof(float); ++byte)
            out[byte * count + n] = bytes[n * sizeof(float) + byte];
}

// Returns where the last stream ends, or 0 if they take more room than the values.
std::size_t packStreams(const std::uint8_t* shuffled, std::size_t bytes, std::size_t streams, char* chunk) {
    thread_local Lz4Table table;
    const std::size_t each = bytes / streams;
    const std::size_t most = bytes + kChunkOverhead;
    std::size_t at = kFirstStream;
    for (std::size_t n = 0; n < streams; ++n) {
        char* const length = chunk + at;
        at += sizeof(std::uint32_t);
        if (at >= most) return 0;
        const auto* stream = reinterpret_cast<const char*>(shuffled + n * each);
        const std::size_t room = std::min(each, most - at);
        auto packed = static_cast<std::size_t>(LZ4_compress_fast_extState_fastReset(
            &table.stream, stream, chunk + at, static_cast<int>(each), static_cast<int>(room), 1));
        if (packed == 0 || packed == each) {  // as it is, if that fits
            if (at + each > most) return 0;
            std::memcpy(chunk + at, stream, each);
            packed = each;
        }
        put(packed, length);
        at += packed;
    }
    return at;
}

}  // namespace

std::size_t packChunk(std::span<const float> values, char* chunk) {
    const std::size_t bytes = values.size_bytes();
    const bool split = values.size() >= kLeastSplitValues;
    std::uint8_t flags = kShuffled | kLz4 | (split ? 0 : kOneStream);
    std::size_t end = 0;
    if (bytes >= kLeastPackedBytes) {
        alignas(64) std::uint8_t shuffled[kMostChunkValues * sizeof(float)];
        shuffle(values, shuffled);
        put(kFirstStream, chunk + kHeadBytes);
        end = packStreams(shuffled, bytes, split ? sizeof(float) : 1, chunk);
    }
    if (end == 0) {
        flags |= kStored;
        std::memcpy(chunk + kHeadBytes, values.data(), bytes);
        end = kHeadBytes + bytes;
    }
    const std::uint8_t head[] = {2, 1, flags, sizeof(float)};  // versions of Blosc's format and of LZ4's
    std::memcpy(chunk, head, sizeof head);
    put(bytes, chunk + 4);
    put(bytes, chunk + 8);  // of a block
    put(end, chunk + 12);
    return end;
}

}  // namespace stratum::exporter
