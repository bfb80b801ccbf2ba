// Work in a process of its own: its memory is counted alone, and what it breaks stays with it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace stratum::study {

struct Outcome {
    std::string text;                ///< what the work returned
    std::string failure;             ///< empty if it returned; else what it threw, or how the process ended
    std::size_t peak_rss_bytes = 0;  ///< largest resident set of that process
};

/// Forks, works in the child, waits. The caller must not have started threads yet: they don't survive a fork, so TBB's
/// first use has to be in the child. A child that takes longer than `seconds` is killed. Throws std::runtime_error only
/// if the system gives no process.
Outcome inOwnProcess(const std::function<std::string()>& work, double seconds = 3600);

/// Largest resident set of this process until now, bytes.
std::size_t peakSoFar();

}  // namespace stratum::study
