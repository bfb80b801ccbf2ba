// Bytes to a file, a megabyte at a time.
#pragma once

#include <cstddef>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

namespace stratum::exporter {

/// Buffers what is written until flush(). Whether it arrived is asked of the stream, after it is closed.
class ChunkWriter {
public:
    /// The stream must outlive it.
    explicit ChunkWriter(std::ofstream& out) : out_(out) { buffer_.reserve(kChunk + 4096); }

    void text(std::string_view text) {
        buffer_.append(text);
        if (buffer_.size() >= kChunk) flush();
    }
    /// As the machine holds it.
    template <typename T>
    void raw(const T& value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        text({bytes, sizeof(T)});
    }
    void flush() {
        out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
        buffer_.clear();
    }

private:
    static constexpr std::size_t kChunk = 1 << 20;
    std::ofstream& out_;
    std::string buffer_;
};

}  // namespace stratum::exporter
