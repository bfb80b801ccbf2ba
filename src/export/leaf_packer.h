// Values of leaves -> their bytes in a .vdb file, as LeafNode::writeBuffers() of OpenVDB writes them.
#pragma once

#include <openvdb/io/Compression.h>
#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <streambuf>
#include <vector>

namespace stratum::exporter {

// The values of a leaf -> a chunk of Blosc 1, with the bytes that c-blosc makes of them.
//
// OpenVDB packs each leaf by itself: up to 2 KB, their bytes shuffled, in four streams of LZ4. For each stream c-blosc
// clears LZ4's table of 16 KB, 32 times the stream itself; here the table stays from stream to stream, which LZ4
// provides for. The format is that of README_CHUNK_FORMAT.rst of c-blosc 1.21.

constexpr std::size_t kMostChunkValues = 512;
/// A chunk has at most so many bytes more than its values.
constexpr std::size_t kChunkOverhead = 16;

/// Writes the chunk of blosc_compress_ctx() at level 9 with the shuffle of bytes, LZ4, and all values in one block;
/// returns its bytes. From any thread.
std::size_t packChunk(std::span<const float> values, char* chunk);

/// How the values of a grid are stored.
struct LeafFormat {
    std::uint32_t compression = 0;  ///< openvdb::io::COMPRESS_*
    bool half = false;
    bool sized() const { return (compression & (openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ZIP)) != 0; }
};

/// What io::DelayedLoadMetadata lists of a leaf.
struct PackedLeaf {
    std::int8_t kind = 0;    ///< of the inactive values, io::MaskCompress::metadata
    std::uint32_t size = 0;  ///< bytes of the active values, with their length before them
};

using LeafMask = openvdb::util::NodeMask<3>;

/// A stream that appends to `out` what OpenVDB writes of a grid of this format. Make one for many leaves.
class PackingStream : private std::streambuf, public std::ostream {
public:
    /// `background`: a value of the grid's type; it must outlive the stream.
    PackingStream(const LeafFormat& format, const void* background, std::vector<char>& out);

private:
    std::streambuf::int_type overflow(std::streambuf::int_type c) override;
    std::streamsize xsputn(const char* bytes, std::streamsize count) override;

    std::vector<char>& out_;
};

/// What the list says of a leaf that OpenVDB has just written: the bytes of `out` from `first` on.
PackedLeaf leafWritten(const LeafFormat& format, const std::vector<char>& out, std::size_t first,
                       std::size_t value_bytes);

/// Whether all inactive values are plus or minus the background, which is above zero.
bool isClamped(const float* values, const LeafMask& active, float background);

/// Appends mask and values of a leaf of a level set whose inactive values are plus or minus the background, as
/// voxelize::LeafReceiver gets them: the same bytes as LeafNode::writeBuffers(), in half the time or less. Re-entrant.
PackedLeaf packClampedLeaf(const LeafFormat& format, const float* values, const LeafMask& active, float background,
                           std::vector<char>& out);

}  // namespace stratum::exporter
