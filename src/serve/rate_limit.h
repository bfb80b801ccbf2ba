// A bucket of tokens: so many events a second in the mean, and twice as many in a burst.
#pragma once

#include <algorithm>
#include <chrono>

namespace stratum::serve {

class RateLimit {
public:
    using Clock = std::chrono::steady_clock;

    explicit RateLimit(double per_second) : per_second_(per_second), left_(2 * per_second) {}
    /// Whether one more event is within the limit.
    bool take(Clock::time_point now = Clock::now()) {
        const std::chrono::duration<double> since = now - last_;
        last_ = now;
        left_ = std::min(2 * per_second_, left_ + std::max(0.0, since.count()) * per_second_);
        if (left_ < 1) return false;
        left_ -= 1;
        return true;
    }

private:
    double per_second_, left_;
    Clock::time_point last_ = Clock::now();
};

}  // namespace stratum::serve
