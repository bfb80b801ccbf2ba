// The bytes of an input file, a pipe or standard input.
#pragma once

#include "base/input_file.h"
#include "gcode/container/byte_buffer.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// Whether a path can be read only once: "-", standard input, or a pipe such as the shell's <(zcat FILE).
bool isStream(const std::string& path);

/// A file, or all of a stream. Movable, not copyable.
class InputBytes {
public:
    /// Whether to wait for the bytes of a stream, or refuse it: where the input is read anew when it has changed.
    enum class Streams : std::uint8_t { read, refuse };
    /// Throws InputError if there is nothing to read, or more than `most` bytes come from a stream.
    explicit InputBytes(const std::string& path, Streams streams = Streams::read,
                        std::size_t most = std::size_t{4} << 30);

    std::string_view bytes() const { return file_ ? file_->bytes() : buffer_.view(); }
    /// For messages: the path, or "standard input".
    const std::string& name() const { return name_; }

private:
    std::string name_;
    std::optional<InputFile> file_;
    ByteBuffer buffer_;
};

/// Reads `descriptor` to its end. Throws InputError.
ByteBuffer readAll(int descriptor, std::string_view name, std::size_t most);

}  // namespace stratum::gcode
