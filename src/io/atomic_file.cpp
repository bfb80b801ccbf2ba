#include "io/atomic_file.h"

#include "io/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace stratum {
namespace {

// A signal handler may only touch lock-free atomics and call unlink(2), so the paths wait in plain, fixed storage.
constexpr int kSlots = 16;
constexpr std::size_t kPathBytes = 4096;
struct Slot {
    std::atomic<bool> taken{false};
    std::atomic<bool> live{false};
    std::array<char, kPathBytes> path{};
};
std::array<Slot, kSlots> g_slots;

int claim(const std::string& path) {
    if (path.size() + 1 > kPathBytes) return -1;
    for (int i = 0; i < kSlots; ++i) {
        Slot& slot = g_slots[static_cast<std::size_t>(i)];
        if (slot.taken.exchange(true)) continue;
        std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
        slot.live.store(true, std::memory_order_release);
        return i;
    }
    return -1;
}

void release(int index) {
    if (index < 0) return;
    Slot& slot = g_slots[static_cast<std::size_t>(index)];
    slot.live.store(false, std::memory_order_release);
    slot.taken.store(false);
}

extern "C" void removeAndDie(int signal) {
    for (Slot& slot : g_slots)
        if (slot.live.load(std::memory_order_acquire)) ::unlink(slot.path.data());
    ::signal(signal, SIG_DFL);
    ::raise(signal);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path destination) : destination_(std::move(destination)) {
    std::filesystem::path directory = destination_.parent_path();
    if (directory.empty()) directory = ".";
    std::error_code ignored;
    if (!std::filesystem::is_directory(directory, ignored))
        throw OutputError(
            fmt::format("{}: the folder {} does not exist; make it first", destination_.string(), directory.string()));
    if (std::filesystem::is_directory(destination_, ignored))
        throw OutputError(fmt::format("{}: is a folder; give the name of a file", destination_.string()));
    temporary_ = directory / fmt::format(".{}.{}.part", destination_.filename().string(), ::getpid());
    slot_ = claim(temporary_.string());
    // The mode a plain open would have given: the umask applies.
    const int fd = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) {
        const int error = errno;
        release(slot_);
        throw OutputError(fmt::format("{}: can't be written ({}); choose another place or mend the permissions",
                                      destination_.string(), std::strerror(error)));
    }
    ::close(fd);
}

AtomicFile::~AtomicFile() {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    release(slot_);
}

void AtomicFile::commit() {
    const int fd = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
    const bool flushed = fd >= 0 && ::fsync(fd) == 0;
    const int error = errno;
    if (fd >= 0) ::close(fd);
    if (!flushed && error == ENOENT)
        throw OutputError(fmt::format("{}: its folder vanished while it was written; make it again and start anew",
                                      destination_.string()));
    if (!flushed)
        throw OutputError(fmt::format("{}: could not be flushed to the disk ({}); is the disk full?",
                                      destination_.string(), std::strerror(error)));
    if (std::rename(temporary_.c_str(), destination_.c_str()) != 0)
        throw OutputError(fmt::format("{}: can't be replaced ({})", destination_.string(), std::strerror(errno)));
    temporary_.clear();
    release(slot_);
    slot_ = -1;
}

void AtomicFile::removeOnSignals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU, SIGXFSZ}) {
        struct sigaction action {};
        action.sa_handler = removeAndDie;
        ::sigaction(signal, &action, nullptr);
    }
}

}  // namespace stratum
