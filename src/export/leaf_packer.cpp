#include "export/leaf_packer.h"

#include "voxelize/leaf/leaf_kernels.h"

#include <hwy/highway.h>
#include <openvdb/io/io.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

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

namespace {

static_assert(sizeof(LeafMask) == 64, "a mask is its words");

constexpr std::uint32_t kBloscOfActive = openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;

void append(const void* bytes, std::size_t count, std::vector<char>& out) {
    out.insert(out.end(), static_cast<const char*>(bytes), static_cast<const char*>(bytes) + count);
}

// As io::bloscToStream() of OpenVDB does it, but straight into `out`.
void appendChunk(std::span<const float> values, std::vector<char>& out) {
    const std::size_t at = out.size();
    out.resize(at + sizeof(std::int64_t) + values.size_bytes() + kChunkOverhead);
    const auto length = static_cast<std::int64_t>(packChunk(values, out.data() + at + sizeof(std::int64_t)));
    std::memcpy(out.data() + at, &length, sizeof length);
    out.resize(at + sizeof length + static_cast<std::size_t>(length));
}

void appendActive(const float* values, const LeafMask& active, std::vector<char>& out) {
    float chosen[LeafMask::SIZE];
    std::size_t count = 0;
    for (openvdb::Index32 word = 0; word < LeafMask::WORD_COUNT; ++word)
        for (std::uint64_t rest = active.getWord<std::uint64_t>(word); rest != 0; rest &= rest - 1)
            chosen[count++] = values[64 * word + static_cast<openvdb::Index32>(std::countr_zero(rest))];
    appendChunk({chosen, count}, out);
}

// Any format, through OpenVDB.
PackedLeaf packByOpenVdb(const LeafFormat& format, const float* values, const LeafMask& active, float background,
                         std::vector<char>& out) {
    const std::size_t first = out.size();
    PackingStream stream(format, &background, out);
    active.save(stream);
    // The signature takes changeable values, and changes none.
    openvdb::io::writeCompressedValues(stream, const_cast<float*>(values), LeafMask::SIZE, active, LeafMask(),
                                       format.half);
    return leafWritten(format, out, first, sizeof(float));
}

}  // namespace

PackingStream::PackingStream(const LeafFormat& format, const void* background, std::vector<char>& out)
    : std::ostream(this), out_(out) {
    openvdb::io::setDataCompression(*this, format.compression);
    openvdb::io::setGridBackgroundValuePtr(*this, background);
}

std::streambuf::int_type PackingStream::overflow(std::streambuf::int_type c) {
    out_.push_back(std::char_traits<char>::to_char_type(c));
    return c;
}

std::streamsize PackingStream::xsputn(const char* bytes, std::streamsize count) {
    out_.insert(out_.end(), bytes, bytes + count);
    return count;
}

PackedLeaf leafWritten(const LeafFormat& format, const std::vector<char>& out, std::size_t first,
                       std::size_t value_bytes) {
    using namespace openvdb::io;
    PackedLeaf leaf;
    leaf.kind = out[first + sizeof(LeafMask)];
    std::size_t before = sizeof(LeafMask) + 1;
    if (leaf.kind == NO_MASK_AND_ONE_INACTIVE_VAL || leaf.kind == MASK_AND_ONE_INACTIVE_VAL) before += value_bytes;
    if (leaf.kind == MASK_AND_TWO_INACTIVE_VALS) before += 2 * value_bytes;
    if (leaf.kind == MASK_AND_NO_INACTIVE_VALS || leaf.kind == MASK_AND_ONE_INACTIVE_VAL ||
        leaf.kind == MASK_AND_TWO_INACTIVE_VALS)
        before += sizeof(LeafMask);
    if (format.sized()) leaf.size = static_cast<std::uint32_t>(out.size() - first - before);
    return leaf;
}

bool isClamped(const float* values, const LeafMask& active, float background) {
    LeafMask within;
    LeafMask up_to;
    voxelize::maskWithin(values, background, &within.getWord<std::uint64_t>(0));
    const float next = std::nextafter(background, std::numeric_limits<float>::infinity());
    voxelize::maskWithin(values, next, &up_to.getWord<std::uint64_t>(0));
    for (openvdb::Index32 word = 0; word < LeafMask::WORD_COUNT; ++word) {
        const std::uint64_t at_it = up_to.getWord<std::uint64_t>(word) & ~within.getWord<std::uint64_t>(word);
        if ((~active.getWord<std::uint64_t>(word) & ~at_it) != 0) return false;
    }
    return true;
}

PackedLeaf packClampedLeaf(const LeafFormat& format, const float* values, const LeafMask& active, float background,
                           std::vector<char>& out) {
    if (format.half || format.compression != kBloscOfActive)
        return packByOpenVdb(format, values, active, background, out);
    LeafMask outside;
    voxelize::maskFrom(values, background, &outside.getWord<std::uint64_t>(0));
    bool any_outside = false;
    bool any_inside = false;
    for (openvdb::Index32 word = 0; word < LeafMask::WORD_COUNT; ++word) {
        const std::uint64_t off = ~active.getWord<std::uint64_t>(word);
        std::uint64_t& out_of_it = outside.getWord<std::uint64_t>(word);
        out_of_it &= off;
        any_outside = any_outside || out_of_it != 0;
        any_inside = any_inside || (off & ~out_of_it) != 0;
    }
    PackedLeaf leaf;
    leaf.kind = openvdb::io::NO_MASK_OR_INACTIVE_VALS;
    if (any_inside)
        leaf.kind = any_outside ? openvdb::io::MASK_AND_NO_INACTIVE_VALS : openvdb::io::NO_MASK_AND_MINUS_BG;
    append(&active, sizeof active, out);
    append(&leaf.kind, 1, out);
    // Of the two inactive values the second is the background.
    if (any_inside && any_outside) append(&outside, sizeof outside, out);
    const std::size_t first = out.size();
    appendActive(values, active, out);
    leaf.size = static_cast<std::uint32_t>(out.size() - first);
    return leaf;
}

}  // namespace stratum::exporter
