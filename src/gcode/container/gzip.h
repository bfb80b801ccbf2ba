// gzip-compressed text, RFC 1952.
#pragma once

#include "gcode/container/container.h"

#include <zlib.h>

#include <new>
#include <string_view>

namespace stratum::gcode {

// RAII wrapper of zlib's decompressor.

/// An open inflate stream. `window_bits` as inflateInit2 has them: 15 for zlib data, 31 for gzip.
class Inflater {
public:
    explicit Inflater(int window_bits) {
        if (inflateInit2(&stream, window_bits) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    /// zlib's text of the last error, for messages.
    std::string_view reason() const { return stream.msg != nullptr ? stream.msg : "the data does not fit together"; }

    z_stream stream{};
};

/// Largest ratio of deflate: 258 bytes from 2 bits.
inline constexpr unsigned kDeflateMostRatio = 1032;

bool isGzip(std::string_view bytes);

/// Unpacks all members, one after the other, and checks the CRC32 and size of each. Throws InputError.
Program openGzip(std::string_view bytes, std::string_view name, const ContainerLimits& limits,
                 const Progress& progress = {});

}  // namespace stratum::gcode
