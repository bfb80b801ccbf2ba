// Work in a process of its own: its memory is counted alone, and what it breaks stays with it.
#pragma once

#include "study/report/table.h"

#include <cstddef>
#include <functional>
#include <string>

namespace stratum::study {

struct Outcome {
    std::string text;                ///< what the work returned
    std::string failure;             ///< empty if it returned; else what it threw, or how the process ended
    std::size_t peak_rss_bytes = 0;  ///< largest resident set of that process
};

/// Forks, works in the child, waits. Threads don't survive a fork, and what they hold stays locked in the child: TBB's
/// are ended before, and start again with its next use on either side. A child that takes longer than `seconds` is
/// killed. Throws std::runtime_error if the system gives no process, or if TBB's threads can't be ended: not from
/// within a parallel loop.
Outcome inOwnProcess(const std::function<std::string()>& work, double seconds = 3600);

/// A row that is measured so, by `threads` of TBB's (0: as many as the machine has). Throws InputError if it is not:
/// `what`, and how it failed.
Row rowInOwnProcess(const std::string& what, int threads, const std::function<Row()>& work);

/// Largest resident set of this process until now, bytes.
std::size_t peakSoFar();

}  // namespace stratum::study
