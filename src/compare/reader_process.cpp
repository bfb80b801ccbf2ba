#include "compare/reader_process.h"

#include "base/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <string_view>
#include <system_error>

namespace stratum::compare {
namespace {

constexpr char kRead = 'r', kRefused = 'x';  // the first byte
constexpr rlim_t kMostSeconds = 120;
// Bytes that a reader may take: what is packed in a .3mf can be a thousand times as long as the file.
constexpr rlim_t kMostBytes = rlim_t{1} << 30;
constexpr rlim_t kMostPerByte = 300;

bool writeAll(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

// What this process has already is not counted.
void limitMemory([[maybe_unused]] const std::string& name) {
#ifndef STRATUM_SANITIZED  // which takes terabytes of addresses
    std::error_code unknown;
    const std::uintmax_t length = std::filesystem::file_size(name, unknown);
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t most = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + kMostBytes +
                        (unknown ? 0 : kMostPerByte * std::min<rlim_t>(length, kMostBytes));
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur <= most) return;
    limit.rlim_cur = most;
    (void)::setrlimit(RLIMIT_AS, &limit);
#endif
}

[[noreturn]] void runChild(int to, const std::string& name, const std::function<std::string()>& read) {
    (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal :
         {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU, SIGXFSZ, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL})
        (void)::signal(signal, SIG_DFL);
    const rlimit no_core{0, 0};
    const rlimit seconds{kMostSeconds, kMostSeconds};
    (void)::setrlimit(RLIMIT_CORE, &no_core);
    (void)::setrlimit(RLIMIT_CPU, &seconds);
    limitMemory(name);
    // What an assertion says means nothing to people. It also empties the copy of the parent's buffer of standard
    // output.
    if (const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC); null >= 0)
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) (void)::dup2(null, stream);
    bool done = false;
    try {
        const std::string bytes = read();
        done = writeAll(to, {&kRead, 1}) && writeAll(to, bytes);
    } catch (const InputError& error) {
        done = writeAll(to, {&kRefused, 1}) && writeAll(to, error.what());
    } catch (const std::exception& error) {
        done = writeAll(to, {&kRefused, 1}) &&
               writeAll(to, fmt::format("{}: can't be read as a model ({}); export it again", name, error.what()));
    }
    ::_exit(done ? 0 : 1);
}

std::string takeAll(int descriptor) {
    std::string bytes;
    std::array<char, 65536> buffer{};
    for (;;) {
        const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return bytes;
        bytes.append(buffer.data(), static_cast<std::size_t>(got));
    }
}

}  // namespace

std::string readInProcess(const std::string& name, const std::function<std::string()>& read) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::bad_alloc();
    const pid_t child = ::fork();
    if (child == 0) runChild(ends[1], name, read);
    ::close(ends[1]);
    if (child < 0) {
        ::close(ends[0]);
        throw std::bad_alloc();
    }
    std::string bytes;
    try {
        bytes = takeAll(ends[0]);
    } catch (...) {
        ::kill(child, SIGKILL);
        ::close(ends[0]);
        (void)::waitpid(child, nullptr, 0);
        throw;
    }
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || bytes.empty())
        throw InputError(fmt::format(
            "{}: can't be read as a model: its reader {}; the file is damaged, export it again", name,
            WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) ? "did not end"
                                                                                                : "crashed"));
    const bool refused = bytes.front() == kRefused;
    bytes.erase(0, 1);
    if (refused) throw InputError(bytes);
    return bytes;
}

}  // namespace stratum::compare
