// Calls that take long: without the GIL, with progress, and ended by Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <type_traits>

namespace stratum::python {

/// To be called by the work now and then with the fraction done, 0..1, from any thread, one at a time. Ends the work by
/// an exception if Python wants that.
using Report = std::function<void(double)>;

/// Runs `work` on a thread of its own. The calling thread waits without the GIL; 20 times a second it takes it, lets
/// Python handle signals, and calls `progress` (a callable, or None) with the fraction done. An exception of either
/// ends the work at its next report, and is then raised; so is the work's own. Needs the GIL.
void runLong(const pybind11::object& progress, const std::function<void(const Report&)>& work);

/// The same for work that returns something.
template <typename Work>
auto callLong(const pybind11::object& progress, const Work& work) {
    std::optional<std::invoke_result_t<Work, const Report&>> result;
    runLong(progress, [&](const Report& report) { result.emplace(work(report)); });
    return std::move(*result);
}

}  // namespace stratum::python
