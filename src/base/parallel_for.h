// The parallel loop of the project: TBB's, with a join that ThreadSanitizer recognizes.
#pragma once

#include <cstddef>

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

/// Calls body(first, last) for parts of [0, count) that cover it once, on the threads that tbb::global_control allows.
/// Parts have about `grain` items. Writes of the bodies are visible after the return. The first exception ends the loop
/// and is rethrown. Results must not depend on the parts: items are independent.
template <typename Body>
void parallelFor(std::size_t count, std::size_t grain, const Body& body) {
#if defined(STRATUM_THREAD_SANITIZER)
    // Debian's TBB is not built for ThreadSanitizer, which then reports races between code before, in and after a loop.
    // With plain threads it sees the real order, so its reports are about this project.
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        try {
            for (std::size_t first = next.fetch_add(grain); first < count; first = next.fetch_add(grain))
                body(first, std::min(first + grain, count));
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
        [&body](const tbb::blocked_range<std::size_t>& part) { body(part.begin(), part.end()); },
        tbb::simple_partitioner());
#endif
}

}  // namespace stratum
