#include "python/threads.h"

#include "python/options/signature.h"

#include "base/error.h"

#include <tbb/global_control.h>

#include <fmt/format.h>

#include <memory>

namespace stratum::python {

namespace py = pybind11;

namespace {

using Limit = tbb::global_control;

// With the GIL.
std::unique_ptr<Limit>& limit() {
    static std::unique_ptr<Limit> limit;
    return limit;
}

void setThreads(const py::object& count) {
    if (count.is_none()) {
        limit().reset();
        return;
    }
    const auto threads = count.cast<long>();
    constexpr long kMost = 1 << 16;
    if (threads < 1 || threads > kMost)
        throw UsageError(
            fmt::format("set_threads({}): expected a number from 1 on, or None for all processors", threads));
    limit() = std::make_unique<Limit>(Limit::max_allowed_parallelism, static_cast<std::size_t>(threads));
}

}  // namespace

void bindThreads(py::module_& module) {
    module.def("set_threads", &setThreads,
               documented("set_threads(count)",
                          "How many threads calls of this process may use; None is all processors. Results don't "
                          "depend on it.")
                   .c_str(),
               py::arg("count"));
    module.def(
        "threads", [] { return Limit::active_value(Limit::max_allowed_parallelism); },
        documented("threads()", "How many threads calls of this process may use, see set_threads().").c_str());
}

}  // namespace stratum::python
