// A file that is written at given places, by one thread at a time.
#pragma once

#include <sys/uio.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <span>
#include <streambuf>
#include <string_view>
#include <vector>

namespace stratum::exporter {

/// Places that are never written read as zeros, and take no room on the disk where the file system has holes.
class PositionedFile {
public:
    /// Opens an existing file, `shown` in messages. Throws OutputError.
    PositionedFile(const std::filesystem::path& path, std::filesystem::path shown);
    ~PositionedFile();
    PositionedFile(const PositionedFile&) = delete;
    PositionedFile& operator=(const PositionedFile&) = delete;

    /// Throws OutputError: the disk is full.
    void write(std::uint64_t at, std::string_view bytes);
    /// All of these, one after the other; changes the list.
    void write(std::uint64_t at, std::span<iovec> parts);
    /// The bytes of this range come `by` bytes earlier. Throws OutputError.
    void moveForward(std::uint64_t from, std::uint64_t to, std::uint64_t by);
    /// The disk may begin to write this range, so that the last flush has less to do.
    void startFlush(std::uint64_t from, std::uint64_t to);
    /// The file ends here. Throws OutputError.
    void finish(std::uint64_t size);

private:
    [[noreturn]] void fail(int error) const;

    std::filesystem::path shown_;
    int fd_ = -1;
};

/// A stream onto such a file, from a place on, with a buffer. flush() at the end; errors are thrown.
class PositionedStream : private std::streambuf, public std::ostream {
public:
    PositionedStream(PositionedFile& file, std::uint64_t at);
    /// The place of the next byte.
    std::uint64_t at() const;
    void writeOut();

private:
    std::streambuf::int_type overflow(std::streambuf::int_type c) override;
    std::streamsize xsputn(const char* bytes, std::streamsize count) override;

    PositionedFile& file_;
    std::uint64_t at_;  // of the buffer's first byte
    std::vector<char> buffer_;
};

}  // namespace stratum::exporter
