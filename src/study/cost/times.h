// How long something takes, and on how many threads.
#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <functional>
#include <vector>

namespace stratum::study {

/// Seconds; `cpu` of all threads.
struct Times {
    double wall = 0, cpu = 0;
};

Times timesOf(const std::function<void()>& work);

/// The upper one of two middle values. At least one value.
double median(std::vector<double> values);

/// While it lives, TBB works with so many threads; 0: as many as the machine has.
inline tbb::global_control limitThreads(int threads) {
    return tbb::global_control(tbb::global_control::max_allowed_parallelism,
                               static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
}

}  // namespace stratum::study
