// The bytes of an input file or of standard input.
#pragma once

#include "base/mapped_file.h"
#include "gcode/container/byte_buffer.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// A file, mapped, or all of standard input for "-". Movable, not copyable.
class InputBytes {
public:
    /// Throws InputError if there is nothing to read, or more than `most` bytes come from standard input.
    explicit InputBytes(const std::string& path, std::size_t most = std::size_t{4} << 30);

    std::string_view bytes() const { return file_ ? file_->bytes() : buffer_.view(); }
    /// For messages: the path, or "standard input".
    const std::string& name() const { return name_; }

private:
    std::string name_;
    std::optional<MappedFile> file_;
    ByteBuffer buffer_;
};

/// Reads `descriptor` to its end. Throws InputError.
ByteBuffer readAll(int descriptor, std::string_view name, std::size_t most);

}  // namespace stratum::gcode
