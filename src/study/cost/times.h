// How long something takes.
#pragma once

#include <functional>

namespace stratum::study {

/// Seconds; `cpu` of all threads.
struct Times {
    double wall = 0, cpu = 0;
};

Times timesOf(const std::function<void()>& work);

}  // namespace stratum::study
