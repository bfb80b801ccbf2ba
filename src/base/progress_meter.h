// Progress of a loop on several threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>

namespace stratum {

/// Calls back at most once a percent, one thread at a time.
class ProgressMeter {
public:
    ProgressMeter(std::size_t total, const std::function<void(double)>& report) : total_(total), report_(report) {}
    void advance(std::size_t count) {
        if (!report_) return;
        const std::size_t done = done_.fetch_add(count, std::memory_order_relaxed) + count;
        if (done * 100 / total_ == (done - count) * 100 / total_) return;
        const std::scoped_lock lock(mutex_);
        report_(static_cast<double>(done) / static_cast<double>(total_));
    }

private:
    const std::size_t total_;
    const std::function<void(double)>& report_;
    std::atomic<std::size_t> done_{0};
    std::mutex mutex_;
};

}  // namespace stratum
