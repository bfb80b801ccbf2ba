#include "export/positioned_file.h"

#include "base/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <utility>

namespace stratum::exporter {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;
constexpr std::size_t kMovedBytes = std::size_t{1} << 20;

}  // namespace

PositionedFile::PositionedFile(const std::filesystem::path& path, std::filesystem::path shown)
    : shown_(std::move(shown)), fd_(::open(path.c_str(), O_RDWR | O_CLOEXEC)) {
    if (fd_ < 0) fail(errno);
}

PositionedFile::~PositionedFile() {
    if (fd_ >= 0) ::close(fd_);
}

void PositionedFile::fail(int error) const { throw writeError(shown_.string(), std::strerror(error)); }

void PositionedFile::write(std::uint64_t at, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) fail(errno);
        at += static_cast<std::uint64_t>(put);
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
}

void PositionedFile::write(std::uint64_t at, std::span<iovec> parts) {
    while (!parts.empty()) {
        const int count = static_cast<int>(std::min<std::size_t>(parts.size(), IOV_MAX));
        const ssize_t put = ::pwritev(fd_, parts.data(), count, static_cast<off_t>(at));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) fail(errno);
        at += static_cast<std::uint64_t>(put);
        auto left = static_cast<std::size_t>(put);
        while (!parts.empty() && left >= parts.front().iov_len) {
            left -= parts.front().iov_len;
            parts = parts.subspan(1);
        }
        if (left == 0) continue;
        parts.front().iov_base = static_cast<char*>(parts.front().iov_base) + left;
        parts.front().iov_len -= left;
    }
}

void PositionedFile::moveForward(std::uint64_t from, std::uint64_t to, std::uint64_t by) {
    std::vector<char> piece(kMovedBytes);
    while (from < to) {
        const std::size_t wanted = std::min<std::uint64_t>(piece.size(), to - from);
        const ssize_t got = ::pread(fd_, piece.data(), wanted, static_cast<off_t>(from));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) fail(got < 0 ? errno : EIO);
        write(from - by, {piece.data(), static_cast<std::size_t>(got)});
        from += static_cast<std::uint64_t>(got);
    }
}

void PositionedFile::startFlush(std::uint64_t from, std::uint64_t to) {
#if defined(__linux__)
    (void)::sync_file_range(fd_, static_cast<off_t>(from), static_cast<off_t>(to - from), SYNC_FILE_RANGE_WRITE);
#else
    (void)from;
    (void)to;
#endif
}

void PositionedFile::finish(std::uint64_t size) {
    if (::ftruncate(fd_, static_cast<off_t>(size)) != 0) fail(errno);
    const int fd = std::exchange(fd_, -1);
    if (::close(fd) != 0) fail(errno);
}

PositionedStream::PositionedStream(PositionedFile& file, std::uint64_t at)
    : std::ostream(this), file_(file), at_(at), buffer_(kBufferBytes) {
    exceptions(std::ios::badbit);  // an exception of the file passes through
    setp(buffer_.data(), buffer_.data() + buffer_.size());
}

std::uint64_t PositionedStream::at() const { return at_ + static_cast<std::uint64_t>(pptr() - pbase()); }

void PositionedStream::writeOut() {
    file_.write(at_, {pbase(), static_cast<std::size_t>(pptr() - pbase())});
    at_ = at();
    setp(buffer_.data(), buffer_.data() + buffer_.size());
}

std::streambuf::int_type PositionedStream::overflow(std::streambuf::int_type c) {
    writeOut();
    if (std::char_traits<char>::eq_int_type(c, std::char_traits<char>::eof()))
        return std::char_traits<char>::not_eof(c);
    return sputc(std::char_traits<char>::to_char_type(c));
}

std::streamsize PositionedStream::xsputn(const char* bytes, std::streamsize count) {
    if (count > epptr() - pptr()) writeOut();
    if (count > epptr() - pptr()) {
        file_.write(at_, {bytes, static_cast<std::size_t>(count)});
        at_ += static_cast<std::uint64_t>(count);
    } else {
        std::memcpy(pptr(), bytes, static_cast<std::size_t>(count));
        pbump(static_cast<int>(count));
    }
    return count;
}

}  // namespace stratum::exporter
