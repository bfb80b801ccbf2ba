// A memory-mapped input file: pages that are not accessed are never loaded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace stratum {

/// The access pattern of a file: for sequential access the system reads ahead, and drops pages that have been read.
enum class Access : std::uint8_t { anywhere, sequential };

/// Read-only map of a regular file. Movable, not copyable; safe to read from several threads.
class MappedFile {
public:
    /// Maps `path`. Throws InputError if it is missing, a directory, unreadable or empty.
    explicit MappedFile(const std::filesystem::path& path, Access access = Access::anywhere);
    ~MappedFile();
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return {data_, size_}; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    const char* data_ = nullptr;
    std::size_t size_ = 0;
};

/// SHA-256 of the bytes as 64 lower-case hex digits, the same as `sha256sum` prints.
std::string sha256Hex(std::string_view bytes);

}  // namespace stratum
