#include "base/input_file.h"

#include "base/error.h"
#include "base/huge_array.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <vector>

namespace stratum {
namespace {

// Large enough that a block costs little more than the copy of its bytes, small enough that a picture of a part of a
// file does not read all of it.
constexpr std::size_t kBlock = std::size_t{1} << 18;
// Files up to this size are read at once, and hold no descriptor.
constexpr std::size_t kSmall = 4 * kBlock;

}  // namespace

struct InputFile::Contents {
    explicit Contents(const std::filesystem::path& of) : path(of) {}
    ~Contents() { close(); }
    Contents(const Contents&) = delete;
    Contents& operator=(const Contents&) = delete;

    void open();
    void close() {
        if (fd >= 0) ::close(fd);
        fd = -1;
    }
    void read(std::size_t from, std::size_t to);
    void loadBlock(std::size_t block);
    void loadAll();

    std::filesystem::path path;
    int fd = -1;
    struct stat opened {};
    std::size_t size = 0;
    HugeArray<char> bytes;
    std::vector<std::atomic<bool>> loaded;  // a flag a block
    std::atomic<bool> all{false};
    std::array<std::mutex, 16> locks;  // of the blocks, in turn
    std::mutex all_lock;
};

void InputFile::Contents::open() {
    // Without O_NONBLOCK the open of a pipe waits for its writer.
    fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        throw InputError(fmt::format("{}: can't be opened ({}); check the name and the permissions", path.string(),
                                     std::strerror(errno)));
    if (::fstat(fd, &opened) != 0 || !S_ISREG(opened.st_mode))
        throw InputError(fmt::format("{}: is not a regular file; give the path of one", path.string()));
    size = static_cast<std::size_t>(opened.st_size);
    if (size == 0) throw InputError(fmt::format("{}: is empty (0 bytes); export it again", path.string()));
    bytes = HugeArray<char>(size);
    loaded = std::vector<std::atomic<bool>>((size + kBlock - 1) / kBlock);
    if (size <= kSmall) loadAll();
}

void InputFile::Contents::read(std::size_t from, std::size_t to) {
    const auto changed = [this] {
        throw InputError(
            fmt::format("{}: changed while it was read; wait until it is complete and start again", path.string()));
    };
    while (from < to) {
        const ssize_t got = ::pread(fd, bytes.data() + from, to - from, static_cast<off_t>(from));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw InputError(fmt::format("{}: can't be read ({})", path.string(), std::strerror(errno)));
        if (got == 0) changed();
        from += static_cast<std::size_t>(got);
    }
    struct stat now {};
    if (::fstat(fd, &now) != 0 || now.st_size != opened.st_size || now.st_mtim.tv_sec != opened.st_mtim.tv_sec ||
        now.st_mtim.tv_nsec != opened.st_mtim.tv_nsec)
        changed();
}

void InputFile::Contents::loadBlock(std::size_t block) {
    if (loaded[block].load(std::memory_order_acquire)) return;
    const std::scoped_lock lock(locks[block % locks.size()]);
    if (loaded[block].load(std::memory_order_relaxed)) return;
    read(block * kBlock, std::min(size, (block + 1) * kBlock));
    loaded[block].store(true, std::memory_order_release);
}

void InputFile::Contents::loadAll() {
    if (all.load(std::memory_order_acquire)) return;
    const std::scoped_lock lock(all_lock);
    for (std::size_t block = 0; block < loaded.size(); ++block) loadBlock(block);
    if (!all.exchange(true, std::memory_order_release)) close();
}

InputFile::InputFile(const std::filesystem::path& path) : contents_(std::make_unique<Contents>(path)) {
    contents_->open();
}
InputFile::~InputFile() = default;
InputFile::InputFile(InputFile&& other) noexcept = default;
InputFile& InputFile::operator=(InputFile&& other) noexcept = default;

std::string_view InputFile::bytes() const {
    contents_->loadAll();
    return unread();
}

std::string_view InputFile::first(std::size_t count) const {
    load(0, std::min(count, size()));
    return unread().substr(0, count);
}

std::string_view InputFile::unread() const { return {contents_->bytes.data(), contents_->size}; }

void InputFile::load(std::size_t offset, std::size_t count) const {
    if (count == 0) return;
    for (std::size_t block = offset / kBlock; block <= (offset + count - 1) / kBlock; ++block)
        contents_->loadBlock(block);
}

std::size_t InputFile::size() const { return contents_->size; }
const std::filesystem::path& InputFile::path() const { return contents_->path; }

}  // namespace stratum
