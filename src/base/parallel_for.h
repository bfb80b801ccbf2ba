// The parallel loop of the project: TBB's, with a join that ThreadSanitizer recognizes. It ends early where the work
// was asked to stop. And one value for each of its threads.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstddef>
#include <memory>
#include <stop_token>

#if defined(STRATUM_THREAD_SANITIZER)
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace stratum {

/// Ends the work that was asked to stop. No std::exception: nobody may take it for a fault of the input.
struct Stopped {};

/// While it lives, this thread works for whoever has the source of the token, and so do the bodies of its
/// parallelFor().
class StopScope {
public:
    /// The token must outlive the scope. Null: nobody can ask.
    explicit StopScope(const std::stop_token* token) : before_(current_) { current_ = token; }
    StopScope(const StopScope&) = delete;
    StopScope& operator=(const StopScope&) = delete;
    ~StopScope() { current_ = before_; }

    /// The token of this thread's work; null: none.
    static const std::stop_token* current() { return current_; }

private:
    static inline constinit thread_local const std::stop_token* current_ = nullptr;
    const std::stop_token* before_;
};

/// Throws Stopped if this thread's work was asked to.
inline void stopIfAsked() {
    const std::stop_token* const token = StopScope::current();
    if (token != nullptr && token->stop_requested()) throw Stopped();
}

/// Calls body(first, last) for parts of [0, count) that cover it once, on the threads that tbb::global_control allows.
/// Parts have about `grain` items. Writes of the bodies are visible after the return. The first exception ends the loop
/// and is rethrown; Stopped is one, if the work of the calling thread is asked to stop (StopScope). Results must not
/// depend on the parts: items are independent.
template <typename Body>
void parallelFor(std::size_t count, std::size_t grain, const Body& body) {
    const auto part = [&body, stop = StopScope::current()](std::size_t first, std::size_t last) {
        const StopScope scope(stop);
        stopIfAsked();
        body(first, last);
    };
#if defined(STRATUM_THREAD_SANITIZER)
    // Debian's TBB is not built for ThreadSanitizer, which then reports races between code before, in and after a loop.
    // With plain threads it sees the real order, so its reports are about this project.
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        try {
            for (std::size_t first = next.fetch_add(grain); first < count; first = next.fetch_add(grain))
                part(first, std::min(first + grain, count));
        } catch (...) {
            const std::scoped_lock lock(failure_mutex);
            failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::thread> threads;
    for (int n = 0; n < 4; ++n) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
#else
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&part](const tbb::blocked_range<std::size_t>& range) { part(range.begin(), range.end()); },
        tbb::simple_partitioner());
#endif
}

/// A value of T per thread, made when the thread asks for it first. local(): this thread's; iteration: all of them, in
/// any order, after the loop. Its memory is that of operator new and not of TBB's allocator: ThreadSanitizer doesn't
/// see into that one, and reports what one thread maps and another fills as a race.
template <typename T>
using PerThread = tbb::enumerable_thread_specific<T, std::allocator<T>>;

}  // namespace stratum
