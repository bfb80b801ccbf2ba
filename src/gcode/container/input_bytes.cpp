#include "gcode/container/input_bytes.h"

#include "base/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace stratum::gcode {
namespace {

struct Descriptor {
    explicit Descriptor(const std::string& path) : fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    const int fd;
};

}  // namespace

bool isStream(const std::string& path) {
    if (path == "-") return true;
    std::error_code ignored;
    return std::filesystem::is_fifo(path, ignored);
}

ByteBuffer readAll(int descriptor, std::string_view name, std::size_t most) {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    ByteBuffer buffer;
    while (true) {
        const std::size_t before = buffer.size();
        char* const start = buffer.extend(kChunk);
        const ssize_t got = ::read(descriptor, start, kChunk);
        buffer.truncate(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
        if (got == 0) break;
        if (got < 0 && errno != EINTR)
            throw InputError(fmt::format("{}: can't be read ({}); give a file or a pipe", name, std::strerror(errno)));
        if (buffer.size() > most)
            throw InputError(fmt::format("{}: more than {} bytes; save it as a file and give that", name, most));
    }
    if (buffer.size() == 0) throw InputError(fmt::format("{}: is empty; pipe G-code into it", name));
    return buffer;
}

InputBytes::InputBytes(const std::string& path, Streams streams, std::size_t most)
    : name_(path == "-" ? "standard input" : path) {
    if (streams == Streams::read && path == "-") {
        buffer_ = readAll(STDIN_FILENO, name_, most);
    } else if (streams == Streams::read && isStream(path)) {
        const Descriptor stream(path);
        buffer_ = readAll(stream.fd, name_, most);
    } else {
        file_.emplace(path);
    }
}

}  // namespace stratum::gcode
