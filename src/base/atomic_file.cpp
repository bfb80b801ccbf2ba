#include "base/atomic_file.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/own_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
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

std::filesystem::path folderOf(const std::filesystem::path& destination) {
    const std::filesystem::path folder = destination.parent_path();
    return folder.empty() ? "." : folder;
}

bool isNumber(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// What the names of the parts of this destination begin with. Names have 255 bytes at most: the end of a long one,
// where numbered pictures differ, is a checksum.
std::string partsBegin(const std::filesystem::path& destination) {
    constexpr std::size_t kMost = 220;
    const std::string name = destination.filename().string();
    if (name.size() <= kMost) return fmt::format(".{}.", name);
    return fmt::format(".{}.{:08x}.", name.substr(0, kMost), checksumOf(name));
}

// Removes files that killed processes with this destination have left: files without a lock.
void sweep(const std::filesystem::path& destination) {
    const std::string begin = partsBegin(destination);
    constexpr std::string_view kEnd = ".part";
    std::error_code error;
    for (std::filesystem::directory_iterator i(folderOf(destination), error), end; !error && i != end;
         i.increment(error)) {
        const std::string name = i->path().filename().string();
        if (name.size() <= begin.size() + kEnd.size() || !name.starts_with(begin) || !name.ends_with(kEnd)) continue;
        if (!isNumber(std::string_view(name).substr(begin.size(), name.size() - begin.size() - kEnd.size()))) continue;
        const int fd = ::open(i->path().c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (fd < 0) continue;
        struct stat status {};
        if (::fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && ::flock(fd, LOCK_EX | LOCK_NB) == 0)
            ::unlink(i->path().c_str());
        ::close(fd);
    }
}

// A device or a pipe; false if nothing exists at the path.
bool isStream(const std::filesystem::path& destination) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(destination, ignored);
    return isStandardOutput(destination) ||
           (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
            !std::filesystem::is_directory(status));
}

// The file that a symbolic link names, which need not be there.
std::filesystem::path targetOf(const std::filesystem::path& destination) {
    constexpr int kMostLinks = 40;  // as many as Linux follows
    std::filesystem::path path = destination;
    for (int n = 0; n < kMostLinks; ++n) {
        std::error_code error;
        if (!std::filesystem::is_symlink(path, error)) return path;
        const std::filesystem::path link = std::filesystem::read_symlink(path, error);
        if (error) break;
        path = link.is_absolute() ? link : path.parent_path() / link;
    }
    throw OutputError(
        fmt::format("{}: is a symbolic link that leads nowhere; give another name", destination.string()));
}

struct Allowed {
    std::mutex mutex;
    bool guarded = false;
    std::multiset<std::string> files;
};

Allowed& allowedFiles() {
    static Allowed allowed;
    return allowed;
}

std::string nameOf(const std::filesystem::path& destination) {
    return isStandardOutput(destination) ? "standard output" : destination.string();
}

}  // namespace

bool isStandardOutput(const std::filesystem::path& destination) {
    const std::string& text = destination.native();
    return text == "-" || (text.starts_with("-.") && text.find('/') == std::string::npos);
}

void Replacement::guard(bool on) {
    const std::scoped_lock lock(allowedFiles().mutex);
    allowedFiles().guarded = on;
}

Replacement::Replacement(const std::filesystem::path& destination, bool allowed)
    : destination_(allowed ? destination.string() : std::string()) {
    if (destination_.empty()) return;
    const std::scoped_lock lock(allowedFiles().mutex);
    allowedFiles().files.insert(destination_);
}

Replacement::~Replacement() {
    if (destination_.empty()) return;
    const std::scoped_lock lock(allowedFiles().mutex);
    allowedFiles().files.extract(destination_);
}

void Replacement::check(const std::filesystem::path& destination) {
    std::error_code missing;
    if (isStream(destination) || !std::filesystem::is_regular_file(destination, missing) ||
        std::filesystem::file_size(destination, missing) == 0)
        return;
    {
        const std::scoped_lock lock(allowedFiles().mutex);
        if (!allowedFiles().guarded || allowedFiles().files.contains(destination.string())) return;
    }
    if (!isOwnFile(destination))
        throw UsageError(fmt::format(
            "{}: is there already, and was not written by this program; give another name, or replace it by "
            "--force",
            destination.string()));
}

void AtomicFile::probe(const std::filesystem::path& destination) {
    if (isStream(destination)) return;
    const AtomicFile file(destination);
}

AtomicFile::AtomicFile(std::filesystem::path destination, Making making) : destination_(std::move(destination)) {
    if (isStream(destination_)) {
        openStream();
        return;
    }
    target_ = targetOf(destination_);
    const std::filesystem::path folder = folderOf(target_);
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw OutputError(
            fmt::format("{}: the folder {} does not exist; make it first", destination_.string(), folder.string()));
    if (std::filesystem::is_directory(target_, ignored))
        throw OutputError(fmt::format("{}: is a folder; give the name of a file", destination_.string()));
    Replacement::check(destination_);
    sweep(target_);
    part_ = folder / fmt::format("{}{}.part", partsBegin(target_), ::getpid());
    if (making == Making::named || !openUnnamed()) openNamed();
}

void AtomicFile::openStream() {
    stream_ = isStandardOutput(destination_) ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)
                                             : ::open(destination_.c_str(), O_WRONLY | O_CLOEXEC);
    if (stream_ < 0)
        throw OutputError(fmt::format("{}: can't be written ({}); choose another place or mend the permissions",
                                      nameOf(destination_), std::strerror(errno)));
    // The C library removes the name at once.
    if (std::FILE* file = std::tmpfile()) {
        fd_ = ::fcntl(::fileno(file), F_DUPFD_CLOEXEC, 0);
        std::fclose(file);
    }
    temporary_ = fmt::format("/proc/self/fd/{}", fd_);
    if (fd_ >= 0 && ::access(temporary_.c_str(), W_OK) == 0) return;
    const int error = errno;
    close();
    throw OutputError(fmt::format("{}: the folder for temporary files can't be written to ({}); give a file",
                                  nameOf(destination_), std::strerror(error)));
}

void AtomicFile::pour() {
    std::array<char, 65536> buffer{};
    for (off_t at = 0;;) {
        const ssize_t got = ::pread(fd_, buffer.data(), buffer.size(), at);
        if (got == 0) break;
        ssize_t done = 0;
        while (got > 0 && done < got) {
            const ssize_t put = ::write(stream_, buffer.data() + done, static_cast<std::size_t>(got - done));
            if (put < 0 && errno == EINTR) continue;
            if (put < 0) throw writeError(nameOf(destination_), std::strerror(errno));
            done += put;
        }
        if (got < 0 && errno != EINTR)
            throw OutputError(fmt::format("{}: what was written for it can't be read again ({})", nameOf(destination_),
                                          std::strerror(errno)));
        if (got > 0) at += got;
    }
    close();
}

// The mode of both is what a plain open would have given: the umask applies.
bool AtomicFile::openUnnamed() {
    fd_ = ::open(folderOf(target_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (fd_ < 0) return false;
    temporary_ = fmt::format("/proc/self/fd/{}", fd_);
    // Without /proc it would have no name to be opened or linked by.
    if (::access(temporary_.c_str(), W_OK) != 0) {
        close();
        return false;
    }
    (void)::flock(fd_, LOCK_EX | LOCK_NB);
    return true;
}

void AtomicFile::openNamed() {
    temporary_ = part_;
    slot_ = claim(part_.string());
    for (;;) {
        fd_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
        if (fd_ < 0) {
            const int error = errno;
            release(slot_);
            throw OutputError(fmt::format("{}: can't be written ({}); choose another place or mend the permissions",
                                          destination_.string(), std::strerror(error)));
        }
        (void)::flock(fd_, LOCK_EX | LOCK_NB);
        struct stat status {};
        // Another process may have removed the file before it was locked.
        if (::fstat(fd_, &status) != 0 || status.st_nlink > 0) return;
        close();
    }
}

void AtomicFile::close() {
    if (fd_ >= 0) ::close(fd_);
    if (stream_ >= 0) ::close(stream_);
    fd_ = stream_ = -1;
}

AtomicFile::~AtomicFile() {
    if (slot_ >= 0 || temporary_ == part_) ::unlink(part_.c_str());
    release(slot_);
    close();
}

void AtomicFile::commit() {
    if (stream_ >= 0) return pour();
    if (::fsync(fd_) != 0)
        throw OutputError(fmt::format("{}: could not be flushed to the disk ({}); is the disk full?",
                                      destination_.string(), std::strerror(errno)));
    if (temporary_ != part_) {
        slot_ = claim(part_.string());
        ::unlink(part_.c_str());
    }
    if ((temporary_ != part_ &&
         ::linkat(AT_FDCWD, temporary_.c_str(), AT_FDCWD, part_.c_str(), AT_SYMLINK_FOLLOW) != 0) ||
        std::rename(part_.c_str(), target_.c_str()) != 0) {
        if (errno == ENOENT)
            throw OutputError(fmt::format("{}: its folder vanished while it was written; make it again and start anew",
                                          destination_.string()));
        throw OutputError(fmt::format("{}: can't be replaced ({})", destination_.string(), std::strerror(errno)));
    }
    part_.clear();
    release(slot_);
    slot_ = -1;
    close();
}

void AtomicFile::write(const std::function<void(const std::filesystem::path&)>& writer) {
    try {
        writer(temporary_);
    } catch (const OutputError& error) {
        std::string text = error.what();
        const std::string from = temporary_.string();
        const std::string to = nameOf(destination_);
        for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
            text.replace(at, from.size(), to);
        throw OutputError(text);
    }
    commit();
}

void AtomicFile::removeOnSignals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU, SIGXFSZ}) {
        struct sigaction action {};
        action.sa_handler = removeAndDie;
        ::sigaction(signal, &action, nullptr);
    }
}

FileWriter::FileWriter(const std::filesystem::path& destination)
    : file_(destination), out_(file_.temporary(), std::ios::binary) {}

void FileWriter::flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
}

void FileWriter::close() {
    flush();
    out_.close();
    if (!out_) throw writeError(file_.destination().string());
}

void FileWriter::commit() {
    if (out_.is_open()) close();
    file_.commit();
}

void writeFile(const std::filesystem::path& destination, std::string_view bytes) {
    FileWriter file(destination);
    // In pieces, since the writer copies what it is given.
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    for (std::size_t at = 0; at < bytes.size(); at += kPiece) file.text(bytes.substr(at, kPiece));
    file.commit();
}

}  // namespace stratum
