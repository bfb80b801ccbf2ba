#include "study/cost/own_process.h"

#include "base/error.h"
#include "study/cost/times.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <new>
#include <stdexcept>
#include <string_view>

namespace stratum::study {
namespace {

// First character of what a child sends.
constexpr char kDone = '+';
constexpr char kThrew = '-';

bool writeAll(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t sent = ::write(descriptor, text.data(), text.size());
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
}

[[noreturn]] void workInChild(const std::function<std::string()>& work, int out) {
    std::string message;
    try {
        message = kDone + work();
    } catch (const std::exception& error) {
        message = kThrew + std::string(error.what());
    }
    // Without the parent's exit handlers: its files are not the child's to clean up.
    ::_exit(writeAll(out, message) ? 0 : 1);
}

// Reads until the child closes its end. False if it did not do so in time.
bool readUntil(int in, std::chrono::steady_clock::time_point end, std::string& text) {
    std::array<char, 4096> part{};
    while (true) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
        pollfd wait{in, POLLIN, 0};
        if (left <= 0 || ::poll(&wait, 1, static_cast<int>(left)) == 0) return false;
        const ssize_t got = ::read(in, part.data(), part.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return true;
        text.append(part.data(), static_cast<std::size_t>(got));
    }
}

// See the header.
void endTaskThreads() {
    tbb::task_scheduler_handle handle{tbb::attach{}};
    if (!tbb::finalize(handle, std::nothrow))
        throw std::runtime_error("a process of its own can't begin in a parallel loop: TBB's threads are at work");
}

}  // namespace

std::size_t peakSoFar() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

Outcome inOwnProcess(const std::function<std::string()>& work, double seconds) {
    endTaskThreads();
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw std::runtime_error("the system gives no pipe");
    const pid_t child = ::fork();
    if (child < 0) {
        ::close(ends[0]);
        ::close(ends[1]);
        throw std::runtime_error("the system gives no process");
    }
    if (child == 0) {
        ::close(ends[0]);
        workInChild(work, ends[1]);
    }
    ::close(ends[1]);
    std::string message;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                            std::chrono::duration<double>(seconds));
    const bool in_time = readUntil(ends[0], end, message);
    ::close(ends[0]);
    if (!in_time) ::kill(child, SIGKILL);
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    Outcome outcome;
    outcome.peak_rss_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
    if (!in_time)
        outcome.failure = fmt::format("took longer than {:g} s", seconds);
    else if (WIFSIGNALED(status))
        outcome.failure = fmt::format("ended by signal {}", WTERMSIG(status));
    else if (message.empty())
        outcome.failure = "ended without a word";
    else if (message.front() == kThrew)
        outcome.failure = message.substr(1);
    else
        outcome.text = message.substr(1);
    return outcome;
}

Row rowInOwnProcess(const std::string& what, int threads, const std::function<Row()>& work) {
    const Outcome outcome = inOwnProcess([&] {
        const tbb::global_control limit = limitThreads(threads);
        return csvLine(work());
    });
    if (!outcome.failure.empty()) throw InputError(fmt::format("{}: {}", what, outcome.failure));
    return parseCsvLine(outcome.text);
}

}  // namespace stratum::study
